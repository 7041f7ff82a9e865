// A stand-in for the part of UnityEngine that the package uses, for tests alone. Unity is not here.
//
// Its types, names and conventions are Unity's (meshes wound clockwise seen from outside; Start, Update,
// LateUpdate in the order of DefaultExecutionOrder); a test moves time on with Stub.Frame. What the
// package does not use is not here. Vectors and the like are in UnityMathStub.cs.
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    public class Object
    {
        private string ownName = "";
        public virtual string name
        {
            get => ownName;
            set => ownName = value;
        }
        public override string ToString() => name;
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }
        public Transform transform => gameObject.transform;
        public override string name
        {
            get => gameObject.name;
            set => gameObject.name = value;
        }
        public T GetComponent<T>() where T : Component => gameObject.GetComponent<T>();
        public T GetComponentInChildren<T>() where T : Component
        {
            T[] all = gameObject.GetComponentsInChildren<T>();
            return all.Length == 0 ? null : all[0];
        }
    }

    public class Transform : Component
    {
        private readonly List<Transform> children = new List<Transform>();
        private Transform above;

        public Vector3 localPosition { get; set; }
        public Quaternion localRotation { get; set; } = Quaternion.identity;
        public Vector3 localScale { get; set; } = Vector3.one;
        internal IReadOnlyList<Transform> Children => children;

        public Transform parent
        {
            get => above;
            set => SetParent(value);
        }

        public void SetParent(Transform parent, bool worldPositionStays = true)
        {
            Vector3 place = position;
            Quaternion turn = rotation;
            above?.children.Remove(this);
            above = parent;
            above?.children.Add(this);
            if (worldPositionStays) SetPositionAndRotation(place, turn);
        }

        public Vector3 position
        {
            get => above == null ? localPosition
                                 : above.position +
                                       above.rotation * Vector3.Scale(above.lossyScale, localPosition);
            set => SetPositionAndRotation(value, rotation);
        }

        public Quaternion rotation
        {
            get => above == null ? localRotation : above.rotation * localRotation;
            set => SetPositionAndRotation(position, value);
        }

        public Vector3 lossyScale =>
            above == null ? localScale : Vector3.Scale(above.lossyScale, localScale);

        public void SetPositionAndRotation(Vector3 place, Quaternion turn)
        {
            if (above == null)
            {
                localPosition = place;
                localRotation = turn;
                return;
            }
            Quaternion back = Quaternion.Inverse(above.rotation);
            Vector3 scale = above.lossyScale;
            localPosition = Vector3.Scale(back * (place - above.position),
                                          new Vector3(1 / scale.x, 1 / scale.y, 1 / scale.z));
            localRotation = back * turn;
        }

        public bool IsChildOf(Transform other)
        {
            for (Transform at = this; at != null; at = at.above)
            {
                if (at == other) return true;
            }
            return false;
        }

        public Matrix4x4 localToWorldMatrix
        {
            get
            {
                // Of scales that are not the same on all axes above turned children, Unity's matrix is a
                // skew one; so is this.
                Matrix4x4 outer = above == null
                    ? new Matrix4x4 {
                          X = new Vector3(1, 0, 0), Y = new Vector3(0, 1, 0), Z = new Vector3(0, 0, 1)
                      }
                    : above.localToWorldMatrix;
                Vector3 origin = outer.MultiplyPoint3x4(localPosition);
                return new Matrix4x4 {
                    X = Column(outer, origin, new Vector3(localScale.x, 0, 0)),
                    Y = Column(outer, origin, new Vector3(0, localScale.y, 0)),
                    Z = Column(outer, origin, new Vector3(0, 0, localScale.z)),
                    Place = origin
                };
            }
        }

        private Vector3 Column(in Matrix4x4 outer, Vector3 origin, Vector3 side) =>
            outer.MultiplyPoint3x4(localPosition + localRotation * side) - origin;
    }

    public enum PrimitiveType
    {
        Cube
    }

    public sealed class GameObject : Object
    {
        private readonly List<Component> components = new List<Component>();

        public GameObject(string name = "")
        {
            this.name = name;
            transform = new Transform { gameObject = this };
            components.Add(transform);
            Stub.Objects.Add(this);
        }

        public Transform transform { get; }
        public int layer { get; set; }
        public bool activeSelf { get; private set; } = true;
        public SceneManagement.Scene scene => default;
        public void SetActive(bool active) => activeSelf = active;

        internal bool IsActive
        {
            get
            {
                for (Transform at = transform; at != null; at = at.parent)
                {
                    if (!at.gameObject.activeSelf) return false;
                }
                return true;
            }
        }

        public T AddComponent<T>() where T : Component => (T)AddComponent(typeof(T));

        public Component AddComponent(Type type)
        {
            var component = (Component)Activator.CreateInstance(type);
            component.gameObject = this;
            components.Add(component);
            if (component is MonoBehaviour behaviour) Stub.Add(behaviour);
            return component;
        }

        public T GetComponent<T>() where T : Component
        {
            foreach (Component component in components)
            {
                if (component is T wanted) return wanted;
            }
            return null;
        }

        public T[] GetComponentsInChildren<T>() where T : Component
        {
            var found = new List<T>();
            Collect(found);
            return found.ToArray();
        }

        private void Collect<T>(List<T> found) where T : Component
        {
            if (!activeSelf) return;
            foreach (Component component in components)
            {
                if (component is T wanted) found.Add(wanted);
            }
            foreach (Transform child in transform.Children) child.gameObject.Collect(found);
        }

        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            var made = new GameObject(type.ToString());
            made.AddComponent<MeshFilter>().sharedMesh = Stub.Cube();
            made.AddComponent<MeshRenderer>();
            return made;
        }
    }

    namespace SceneManagement
    {
        public struct Scene
        {
            public GameObject[] GetRootGameObjects() =>
                Stub.Objects.FindAll(some => some.transform.parent == null).ToArray();
        }
    }

    public class Behaviour : Component
    {
        private bool isOn = true;
        public bool enabled
        {
            get => isOn;
            set
            {
                if (isOn == value) return;
                isOn = value;
                Stub.Enabled((MonoBehaviour)this, value);
            }
        }
    }

    public class MonoBehaviour : Behaviour {}
    public sealed class Camera : Component
    {
        public static Camera main => null;
    }

    public class Renderer : Component
    {
        public bool isPartOfStaticBatch { get; set; }
    }
    public sealed class MeshRenderer : Renderer {}

    public sealed class TextMesh : Component
    {
        public string text { get; set; } = "";
    }

    public enum MeshTopology
    {
        Triangles = 0,
        Lines = 3
    }

    public sealed class MeshFilter : Component
    {
        public Mesh sharedMesh { get; set; }
    }

    public sealed class Mesh : Object
    {
        internal Vector3[] Vertices = new Vector3[0];
        internal readonly List<int[]> Parts = new List<int[]>();
        internal readonly List<MeshTopology> Topologies = new List<MeshTopology>();
        public bool isReadable { get; set; } = true;
        public int subMeshCount => Parts.Count;
        public void GetVertices(List<Vector3> list)
        {
            list.Clear();
            list.AddRange(Vertices);
        }
        public MeshTopology GetTopology(int part) => Topologies[part];
        public int[] GetIndices(int part) => Parts[part];
    }

    public sealed class TextAsset : Object
    {
        public TextAsset(byte[] bytes) { this.bytes = bytes; }
        public byte[] bytes { get; }
    }

    public static class Time
    {
        public static float unscaledDeltaTime { get; internal set; }
        public static float deltaTime => unscaledDeltaTime;
    }

    public static class Debug
    {
        public static void Log(object message, Object about = null) => Stub.Console.Add("log: " + message);
        public static void LogWarning(object message, Object about = null) =>
            Stub.Console.Add("warning: " + message);
        public static void LogError(object message, Object about = null) =>
            Stub.Console.Add("error: " + message);
        public static void DrawLine(Vector3 from, Vector3 to, Color color) => ++Stub.Lines;
    }

    public static class GUI
    {
        public static void Label(Rect place, string text) => Stub.Shown = text;
    }

    public static class GUILayout
    {
        public static bool Button(string text) => false;
    }

    public static class Screen
    {
        public static int width => 1280;
        public static int height => 720;
    }

    namespace Events
    {
        public delegate void UnityAction<T>(T argument);

        public class UnityEvent<T>
        {
            private event UnityAction<T> Listeners;
            public void AddListener(UnityAction<T> listener) => Listeners += listener;
            public void Invoke(T argument) => Listeners?.Invoke(argument);
        }
    }

    // ---- attributes -------------------------------------------------------------------------------

    public sealed class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string text) {}
    }
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class HeaderAttribute : Attribute
    {
        public HeaderAttribute(string text) {}
    }
    public sealed class MinAttribute : Attribute
    {
        public MinAttribute(float least) {}
    }
    public sealed class RangeAttribute : Attribute
    {
        public RangeAttribute(float least, float most) {}
    }
    public sealed class AddComponentMenu : Attribute
    {
        public AddComponentMenu(string place) {}
    }
    public sealed class DisallowMultipleComponent : Attribute {}
    public sealed class RequireComponent : Attribute
    {
        public RequireComponent(Type type) {}
    }
    public sealed class DefaultExecutionOrder : Attribute
    {
        public int Order { get; }
        public DefaultExecutionOrder(int order) { Order = order; }
    }

    // ---- what the stub itself has: its scene, its clock -------------------------------------------

    public static class Stub
    {
        public static readonly List<GameObject> Objects = new List<GameObject>();
        public static readonly List<string> Console = new List<string>();
        public static int Lines;
        public static string Shown = "";

        private sealed class Life
        {
            public MonoBehaviour Behaviour;
            public Action Start, Update, LateUpdate, OnGUI;
            public bool HasStarted;
            public int Order;
        }
        private static readonly List<Life> lives = new List<Life>();

        /// <summary>An empty scene, no listener, nothing in the console.</summary>
        public static void Clear()
        {
            foreach (Life life in lives) life.Behaviour.enabled = false;
            lives.Clear();
            Objects.Clear();
            Console.Clear();
            Lines = 0;
            Shown = "";
        }

        /// <summary>A frame of the player's loop, so many seconds after the one before. Allocates nothing
        /// itself, but for what starts.</summary>
        public static void Frame(float seconds)
        {
            Time.unscaledDeltaTime = seconds;
            for (int i = 0; i < lives.Count; ++i)
            {
                Life life = lives[i];
                if (life.HasStarted || !IsOn(life)) continue;
                life.HasStarted = true;
                life.Start?.Invoke();
            }
            for (int i = 0; i < lives.Count; ++i) if (IsOn(lives[i])) lives[i].Update?.Invoke();
            for (int i = 0; i < lives.Count; ++i) if (IsOn(lives[i])) lives[i].LateUpdate?.Invoke();
            for (int i = 0; i < lives.Count; ++i) if (IsOn(lives[i])) lives[i].OnGUI?.Invoke();
        }

        private static bool IsOn(Life life) =>
            life.Behaviour.enabled && life.Behaviour.gameObject.IsActive;

        internal static void Add(MonoBehaviour behaviour)
        {
            var order = behaviour.GetType().GetCustomAttribute<DefaultExecutionOrder>();
            var life = new Life {
                Behaviour = behaviour,
                Start = Message(behaviour, "Start"),
                Update = Message(behaviour, "Update"),
                LateUpdate = Message(behaviour, "LateUpdate"),
                OnGUI = Message(behaviour, "OnGUI"),
                Order = order == null ? 0 : order.Order
            };
            int at = lives.FindIndex(other => other.Order > life.Order);
            lives.Insert(at < 0 ? lives.Count : at, life);
            Message(behaviour, "Awake")?.Invoke();
            Message(behaviour, "OnEnable")?.Invoke();
        }

        internal static void Enabled(MonoBehaviour behaviour, bool enabled) =>
            Message(behaviour, enabled ? "OnEnable" : "OnDisable")?.Invoke();

        private static Action Message(MonoBehaviour behaviour, string name)
        {
            MethodInfo method = behaviour.GetType().GetMethod(
                name, BindingFlags.Instance | BindingFlags.NonPublic | BindingFlags.Public, null,
                Type.EmptyTypes, null);
            return method == null ? null : (Action)method.CreateDelegate(typeof(Action), behaviour);
        }

        /// <summary>Of side 1 about the origin, wound clockwise seen from outside.</summary>
        public static Mesh Cube()
        {
            var vertices = new Vector3[8];
            for (int i = 0; i < 8; ++i)
            {
                vertices[i] = new Vector3((i & 1) - 0.5f, (i >> 1 & 1) - 0.5f, (i >> 2) - 0.5f);
            }
            return MeshOf("Cube", vertices, new[] {
                2, 6, 7, 2, 7, 3,  // up
                0, 1, 5, 0, 5, 4,  // down
                0, 2, 3, 0, 3, 1,  // back
                4, 5, 7, 4, 7, 6,  // front
                0, 4, 6, 0, 6, 2,  // left
                1, 3, 7, 1, 7, 5   // right
            });
        }

        public static Mesh MeshOf(string name, Vector3[] vertices, params int[][] parts)
        {
            var mesh = new Mesh { name = name, Vertices = vertices };
            foreach (int[] part in parts)
            {
                mesh.Parts.Add(part);
                mesh.Topologies.Add(part.Length % 3 == 0 ? MeshTopology.Triangles : MeshTopology.Lines);
            }
            return mesh;
        }
    }
}
