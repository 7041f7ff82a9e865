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

        public void Dispose() => Handle.Dispose();
    }
}
