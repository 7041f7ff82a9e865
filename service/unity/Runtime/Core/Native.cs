// The border itself: forewalk.h's functions, and its structs that hold pointers. Nothing else in the
// package calls the library.
//
// Structs that the library fills or reads by struct_size are passed with ours, so that a newer library
// leaves alone what this package does not know (see forewalk.h, "Structs carry their own size").
using System;
using System.Runtime.InteropServices;

#pragma warning disable 0649 // the library fills some

namespace Forewalk
{
    [StructLayout(LayoutKind.Sequential)]
    internal struct NativeBuildSettings
    {
        public uint StructSize;
        public int ZUp;
        public float MetresPerUnit;
        public float Radius;
        public float Height;
        public float Climb;
        public float Slope;
        public float Cell;
        public float CellHeight;
        public float Tile;
        public Partition Partition;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeSpaceSettings
    {
        public uint StructSize;
        public Axes Axes;
        public Point2* Border;
        public UIntPtr BorderCount;
        public float Width, Depth;
        public Point2* HolePoints;
        public UIntPtr* HoleSizes;
        public UIntPtr HoleCount;
        public float BodyRadius;
        public uint UserLimit;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeSessionSettings
    {
        public uint StructSize;
        public Axes Axes;
        public Controller Controller;
        public GainLimits Limits;
        public float Horizon;
        public Point2* Border;
        public UIntPtr BorderCount;
        public float Width, Depth;
        public Point2* HolePoints;
        public UIntPtr* HoleSizes;
        public UIntPtr HoleCount;
        public int HasStart;
        public Vec3 StartFloor;
        public float StartHeading;
        public float TranslationMin, TranslationMax;
        public float RotationMin, RotationMax;
        public float CurvatureMax;
        public float BendingMin, BendingMax;
        public uint PolygonLimit;
        public int Resets;
        public int AlwaysPredict;
        public uint Reserved;
        public PredictionMethod Method;
        public float Persistence;
        public ResetMethod Reset;
        public uint Reserved2;
        public int Likelihoods;
        public HeadingSource HeadingSource;
        public IntPtr Space;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeGraphView
    {
        public uint StructSize;
        public uint NodeCount;
        public Node* Nodes;
        public uint EdgeCount;
        public uint PointCount;
        public Edge* Edges;
        public Vec3* Points;
        public float Horizon;
        public float CompleteTo;
        public Front* Fronts;
        public float* Widths;
        public uint FrontCount;
        public PredictionMethod Method;
        public Way* Ways;
        public WayEvent* WayEvents;
        public uint WayCount;
        public uint WayEventCount;
        public float LikelihoodNone;
        public uint Reserved;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeNavmeshView
    {
        public uint StructSize;
        public uint PolygonCount;
        public uint* CornerStart;
        public Vec3* Corners;
        public uint* PortalStart;
        public Portal* Portals;
        public uint* TriangleStart;
        public Vec3* Triangles;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeDoor
    {
        public uint Id;
        public int Open;
        public Vec3* Corners;
        public UIntPtr CornerCount;
        public float Height;
        public float Cost;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeObstacle
    {
        public uint Id;
        public ObstacleShape Shape;
        public Vec3 Position;
        public Vec3 HalfSize;
        public float Heading;
        public float Radius;
        public float Height;
        public Vec3* Corners;
        public UIntPtr CornerCount;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeWorldSettings
    {
        public uint StructSize;
        public Axes Axes;
        public NativeBuildSettings* Build;
        public NativeDoor* Doors;
        public UIntPtr DoorCount;
    }

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    internal delegate void NativeLogFunction(IntPtr user, LogLevel level, IntPtr message);

    internal static unsafe class Native
    {
#if (UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR
        private const string Library = "__Internal";
#else
        private const string Library = "forewalk";
#endif
        private const CallingConvention C = CallingConvention.Cdecl;

        [DllImport(Library, CallingConvention = C)]
        public static extern uint forewalk_version();
        [DllImport(Library, CallingConvention = C)]
        public static extern IntPtr forewalk_last_error();
        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_set_log(NativeLogFunction function, IntPtr user,
                                                   LogLevel most);

        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_build_settings_init(void* settings, uint structSize);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_navmesh_from_file(byte* path,
            NativeBuildSettings* settings, out NavMeshHandle navmesh);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_navmesh_from_triangles(float* vertices,
            UIntPtr vertexCount, uint* indices, UIntPtr indexCount, Axes axes,
            NativeBuildSettings* settings, out NavMeshHandle navmesh);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_navmesh_from_fwmesh(byte* bytes, UIntPtr byteCount,
                                                                 out NavMeshHandle navmesh);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_navmesh_save(NavMeshHandle navmesh, byte* buffer,
                                                          ref UIntPtr byteCount);
        [DllImport(Library, CallingConvention = C)]
        public static extern uint forewalk_navmesh_polygon_count(NavMeshHandle navmesh);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_navmesh_polygons(NavMeshHandle navmesh, Axes axes,
                                                              ref NativeNavmeshView view);
        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_navmesh_release(IntPtr navmesh);

        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_space_settings_init(void* settings, uint structSize);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_space_create(NativeSpaceSettings* settings,
                                                          out SpaceHandle space);
        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_space_release(IntPtr space);

        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_session_settings_init(void* settings, uint structSize);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_create(NavMeshHandle navmesh,
            NativeSessionSettings* settings, out SessionHandle session);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_create_in_world(WorldHandle world,
            NativeSessionSettings* settings, out SessionHandle session);
        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_session_destroy(IntPtr session);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_frame(SessionHandle session, Vec3 headPosition,
            Quat headOrientation, double seconds, ref FrameOut result);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_graph(SessionHandle session, ref NativeGraphView view);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_teleport(SessionHandle session, Vec3 floor,
                                                              float heading);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_set_gaze(SessionHandle session, Vec3* direction);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_set_chest(SessionHandle session, Vec3* direction);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_record(SessionHandle session, byte* path);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_set_links(SessionHandle session, Link* links,
                                                               UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_set_standing(SessionHandle session,
                                                                  Standing* standing, UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_session_enter(SessionHandle session,
                                                           NavMeshHandle navmesh);

        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_world_settings_init(void* settings, uint structSize);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_from_file(byte* path,
            NativeWorldSettings* settings, out WorldHandle world);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_from_triangles(float* vertices,
            UIntPtr vertexCount, uint* indices, UIntPtr indexCount, NativeWorldSettings* settings,
            out WorldHandle world);
        [DllImport(Library, CallingConvention = C)]
        public static extern void forewalk_world_release(IntPtr world);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_set_obstacles(WorldHandle world,
            NativeObstacle* obstacles, UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_remove_obstacle(WorldHandle world, uint id);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_set_door(WorldHandle world, NativeDoor* door);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_set_link(WorldHandle world, Link* link);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_remove_link(WorldHandle world, uint id);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_set_standing(WorldHandle world, Standing* standing,
                                                                UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern Status forewalk_world_wait(WorldHandle world);
        [DllImport(Library, CallingConvention = C)]
        public static extern ulong forewalk_world_version(WorldHandle world);
    }

    internal abstract class ForewalkHandle : SafeHandle
    {
        protected ForewalkHandle() : base(IntPtr.Zero, true) {}

        public override bool IsInvalid => handle == IntPtr.Zero;
    }

    internal sealed class NavMeshHandle : ForewalkHandle
    {
        protected override bool ReleaseHandle()
        {
            Native.forewalk_navmesh_release(handle);
            return true;
        }
    }

    internal sealed class SpaceHandle : ForewalkHandle
    {
        protected override bool ReleaseHandle()
        {
            Native.forewalk_space_release(handle);
            return true;
        }
    }

    internal sealed class SessionHandle : ForewalkHandle
    {
        protected override bool ReleaseHandle()
        {
            Native.forewalk_session_destroy(handle);
            return true;
        }
    }

    internal sealed class WorldHandle : ForewalkHandle
    {
        protected override bool ReleaseHandle()
        {
            Native.forewalk_world_release(handle);
            return true;
        }
    }
}
