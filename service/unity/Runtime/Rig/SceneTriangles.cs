using System.Collections.Generic;
using UnityEngine;

namespace Forewalk.Unity
{
    /// <summary>The triangles of a scene's meshes, in the places that they have in the world.</summary>
    public sealed class SceneTriangles
    {
        private readonly List<Vec3> vertices = new List<Vec3>();
        private readonly List<int> indices = new List<int>();
        private readonly List<string> skipped = new List<string>();
        private readonly List<Vector3> meshVertices = new List<Vector3>();

        public Vec3[] Vertices => vertices.ToArray();
        public int[] Indices => indices.ToArray();
        /// <summary>A sentence for each mesh that could not be read.</summary>
        public IReadOnlyList<string> Skipped => skipped;

        /// <summary>Adds the meshes of all active MeshFilters at and below `root` whose layer is one of
        /// `layers`, but for what is at or below `except` (null is fine): a user's hands are no
        /// floor.</summary>
        public void Add(GameObject root, LayerMask layers, Transform except)
        {
            foreach (MeshFilter filter in root.GetComponentsInChildren<MeshFilter>())
            {
                if ((layers.value & 1 << filter.gameObject.layer) == 0) continue;
                if (except != null && filter.transform.IsChildOf(except)) continue;
                Add(filter);
            }
        }

        private void Add(MeshFilter filter)
        {
            Mesh mesh = filter.sharedMesh;
            if (mesh == null) return;
            var shown = filter.GetComponent<Renderer>();
            if (shown != null && shown.isPartOfStaticBatch)
            {
                skipped.Add($"'{filter.name}' is part of a static batch, whose triangles cannot be told " +
                            "apart. Untick Batching Static of it, or bake the navmesh.");
                return;
            }
            if (!mesh.isReadable)
            {
                skipped.Add($"The mesh '{mesh.name}' of '{filter.name}' cannot be read. Tick Read/Write " +
                            "in its import settings, or bake the navmesh.");
                return;
            }

            int first = vertices.Count;
            Matrix4x4 toWorld = filter.transform.localToWorldMatrix;
            mesh.GetVertices(meshVertices);
            foreach (Vector3 v in meshVertices) vertices.Add(toWorld.MultiplyPoint3x4(v).ToForewalk());
            // Mirrored objects turn their triangles inside out.
            bool isMirrored = toWorld.determinant < 0;
            for (int part = 0; part < mesh.subMeshCount; ++part)
            {
                if (mesh.GetTopology(part) != MeshTopology.Triangles) continue;
                int[] corners = mesh.GetIndices(part);
                for (int i = 0; i + 2 < corners.Length; i += 3)
                {
                    indices.Add(first + corners[i]);
                    indices.Add(first + corners[isMirrored ? i + 2 : i + 1]);
                    indices.Add(first + corners[isMirrored ? i + 1 : i + 2]);
                }
            }
        }
    }
}
