using System.IO;
using UnityEditor;
using UnityEngine;

namespace Forewalk.Unity.Editing
{
    /// <summary>The rig's inspector, with a button that bakes the navmesh into an asset: loaded in
    /// milliseconds, and no mesh needs to be readable in a built player.</summary>
    [CustomEditor(typeof(RedirectedRig))]
    public sealed class RedirectedRigEditor : Editor
    {
        public override void OnInspectorGUI()
        {
            DrawDefaultInspector();
            if (GUILayout.Button("Bake NavMesh")) Bake((RedirectedRig)target);
        }

        private static void Bake(RedirectedRig rig)
        {
            string file = EditorUtility.SaveFilePanelInProject(
                "Bake NavMesh", rig.name + ".fwmesh", "bytes", "Where the navmesh goes.");
            if (string.IsNullOrEmpty(file)) return;
            try
            {
                BakeTo(rig, file);
            }
            catch (ForewalkException refusal)
            {
                EditorUtility.DisplayDialog("Bake NavMesh", refusal.Message, "OK");
            }
        }

        /// <summary>Builds the navmesh of the rig's scene into `file`, a path of the project that ends in
        /// .bytes, and makes it the rig's. For build scripts, too.</summary>
        /// <exception cref="ForewalkException">Nothing walkable, and the like.</exception>
        public static void BakeTo(RedirectedRig rig, string file)
        {
            using (ForewalkNavMesh navmesh = rig.BuildNavMesh())
            {
                File.WriteAllBytes(file, navmesh.Save());
            }
            AssetDatabase.ImportAsset(file);
            Undo.RecordObject(rig, "Bake NavMesh");
            rig.navMeshAsset = AssetDatabase.LoadAssetAtPath<TextAsset>(file);
            rig.navMeshSource = NavMeshSource.Asset;
            EditorUtility.SetDirty(rig);
        }
    }
}
