// A stand-in for the part of UnityEditor that the package uses, as UnityEngineStub.cs. Assets are files.
using System;
using System.IO;
using UnityEngine;

namespace UnityEditor
{
    public class Editor
    {
        public UnityEngine.Object target;
        public virtual void OnInspectorGUI() {}
        public bool DrawDefaultInspector() => true;
    }

    public sealed class CustomEditor : Attribute
    {
        public CustomEditor(Type of) {}
    }

    public static class EditorUtility
    {
        public static string SaveFilePanelInProject(string title, string name, string ending,
                                                    string message) => "";
        public static bool DisplayDialog(string title, string message, string ok) => true;
        public static void SetDirty(UnityEngine.Object changed) {}
    }

    public static class Undo
    {
        public static void RecordObject(UnityEngine.Object changed, string name) {}
    }

    public static class AssetDatabase
    {
        private static string imported = "";
        public static void ImportAsset(string file) => imported = file;
        public static T LoadAssetAtPath<T>(string file) where T : UnityEngine.Object =>
            file == imported ? new TextAsset(File.ReadAllBytes(file)) as T : null;
    }
}
