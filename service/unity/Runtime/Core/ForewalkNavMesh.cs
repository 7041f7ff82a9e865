using System;
using System.IO;

namespace Forewalk
{
    /// <summary>Where one can walk. Made once, then only read: shared by any number of sessions, on any
    /// threads. Sessions keep what they need of it, so it may be disposed of while they live.</summary>
    public sealed unsafe class ForewalkNavMesh : IDisposable
    {
        internal readonly NavMeshHandle Handle;

        private ForewalkNavMesh(NavMeshHandle handle)
        {
            Handle = handle;
        }

        /// <summary>Builds from a scene file (.obj .off .ply .stl .gltf .glb), or loads a .fwmesh; the
        /// settings are then not used. Scene files and .fwmesh hold OpenXR's axes: a place (x, y, z) of
        /// them is (x, y, -z) here. Blocks for 50 to 100 ms for a scene of 40 m x 25 m.</summary>
        /// <exception cref="ForewalkException">No such file, nothing walkable in it, and the
        /// like.</exception>
        public static ForewalkNavMesh FromFile(string path, BuildSettings settings = null)
        {
            ForewalkLibrary.Load();
            byte[] bytes = ForewalkLibrary.BytesOf(path);
            NativeBuildSettings native = settings == null ? default : settings.ToNative();
            fixed (byte* text = bytes)
            {
                ForewalkLibrary.Check(Native.forewalk_navmesh_from_file(
                    text, settings == null ? null : &native, out NavMeshHandle handle));
                return new ForewalkNavMesh(handle);
            }
        }

        /// <summary>Builds from triangles, three indices each: in Unity's axes and winding (clockwise
        /// seen from outside), in the places that they have in the world. Costs as
        /// <see cref="FromFile"/>.</summary>
        public static ForewalkNavMesh FromTriangles(Vec3[] vertices, int[] indices,
                                                    BuildSettings settings = null)
        {
            if (vertices == null) throw new ArgumentNullException(nameof(vertices));
            if (indices == null) throw new ArgumentNullException(nameof(indices));
            ForewalkLibrary.Load();
            NativeBuildSettings native = settings == null ? default : settings.ToNative();
            fixed (Vec3* points = vertices)
            fixed (int* corners = indices)
            {
                ForewalkLibrary.Check(Native.forewalk_navmesh_from_triangles(
                    (float*)points, ForewalkLibrary.Count(vertices), (uint*)corners,
                    ForewalkLibrary.Count(indices), Axes.Unity, settings == null ? null : &native,
                    out NavMeshHandle handle));
                return new ForewalkNavMesh(handle);
            }
        }

        /// <summary>Loads the bytes of a .fwmesh, from <see cref="Save"/> or from `forewalk build`, in a
        /// few milliseconds. Bytes that are damaged are refused; they may come from anywhere.</summary>
        public static ForewalkNavMesh FromFwmesh(byte[] bytes)
        {
            if (bytes == null) throw new ArgumentNullException(nameof(bytes));
            ForewalkLibrary.Load();
            // An empty array has no address; the library shall say what it thinks of no bytes.
            byte none = 0;
            fixed (byte* some = bytes)
            {
                ForewalkLibrary.Check(Native.forewalk_navmesh_from_fwmesh(
                    some == null ? &none : some, ForewalkLibrary.Count(bytes),
                    out NavMeshHandle handle));
                return new ForewalkNavMesh(handle);
            }
        }

        /// <summary>The bytes of a .fwmesh of this navmesh.</summary>
        public byte[] Save()
        {
            var count = UIntPtr.Zero;
            ForewalkLibrary.Check(Native.forewalk_navmesh_save(Handle, null, ref count));
            var bytes = new byte[count.ToUInt64()];
            fixed (byte* buffer = bytes)
            {
                ForewalkLibrary.Check(Native.forewalk_navmesh_save(Handle, buffer, ref count));
            }
            return bytes;
        }

        public int PolygonCount => (int)Native.forewalk_navmesh_polygon_count(Handle);

        /// <summary>The walkable polygons, to draw and to pick from; <see cref="Node.Polygon"/> is a place
        /// in it. Copies: not for every frame.</summary>
        public Polygon[] Polygons()
        {
            var view = new NativeNavmeshView { StructSize = (uint)sizeof(NativeNavmeshView) };
            ForewalkLibrary.Check(Native.forewalk_navmesh_polygons(Handle, Axes.Unity, ref view));
            var polygons = new Polygon[view.PolygonCount];
            for (int i = 0; i < polygons.Length; ++i)
            {
                uint corner = view.CornerStart[i], portal = view.PortalStart[i];
                uint triangle = 3 * view.TriangleStart[i];
                var made = new Polygon(new Vec3[view.CornerStart[i + 1] - corner],
                                       new Portal[view.PortalStart[i + 1] - portal],
                                       new Vec3[3 * view.TriangleStart[i + 1] - triangle]);
                for (int k = 0; k < made.Corners.Length; ++k) made.Corners[k] = view.Corners[corner + k];
                for (int k = 0; k < made.Portals.Length; ++k) made.Portals[k] = view.Portals[portal + k];
                for (int k = 0; k < made.Triangles.Length; ++k)
                {
                    made.Triangles[k] = view.Triangles[triangle + k];
                }
                polygons[i] = made;
            }
            GC.KeepAlive(this);
            return polygons;
        }

        public void Dispose() => Handle.Dispose();
    }

    /// <summary>Of a <see cref="ForewalkNavMesh"/>.</summary>
    public sealed class Polygon
    {
        /// <summary>Convex; counter-clockwise seen from above.</summary>
        public readonly Vec3[] Corners;
        /// <summary>Ways out of it, in the order of edges.</summary>
        public readonly Portal[] Portals;
        /// <summary>The surface at its true height, three corners each, counter-clockwise seen from above:
        /// the other way round than Unity's meshes.</summary>
        public readonly Vec3[] Triangles;

        internal Polygon(Vec3[] corners, Portal[] portals, Vec3[] triangles)
        {
            Corners = corners;
            Portals = portals;
            Triangles = triangles;
        }
    }
}
