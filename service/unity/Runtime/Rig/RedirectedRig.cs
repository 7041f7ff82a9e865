using System;
using UnityEngine;

namespace Forewalk.Unity
{
    /// <summary>Where a rig gets its navmesh from.</summary>
    public enum NavMeshSource
    {
        /// <summary>Built from the meshes of the scene when the walk begins.</summary>
        SceneMeshes,
        /// <summary>A .fwmesh, baked or made by `forewalk build`.</summary>
        Asset,
        /// <summary>A script calls Begin.</summary>
        Script
    }

    /// <summary>Walks a tracked camera through a scene larger than the room. Put it on what the camera
    /// stands below: the camera's parent, an XR Origin. Tracking moves the camera in it, as ever; this
    /// moves the rig, each frame, so that the camera is where the redirected user is.</summary>
    /// <remarks>
    /// It begins in its first LateUpdate, when other scripts have made their scene in Start, from where
    /// the rig stands: the camera does not jump. It leaves the rig where it is when disabled, and begins
    /// anew when enabled. The rig must be upright and of scale 1.
    ///
    /// Runs in LateUpdate before other scripts'. Tracking that comes after it (before rendering) moves
    /// the camera within the rig, which is right: until the next frame the map between the room and the
    /// scene stands still. A frame costs some 5 to 20 microseconds and leaves no garbage.
    /// </remarks>
    [AddComponentMenu("Forewalk/Redirected Rig")]
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-100)]
    public sealed class RedirectedRig : MonoBehaviour
    {
        [Header("User")]
        [Tooltip("The tracked camera, at or below this object. None: the first camera below it.")]
        public Transform head;

        [Header("Building")]
        [Tooltip("Where one can walk. Scene Meshes: built from the scene's meshes when the walk begins, " +
                 "some 0.1 s for a floor of 1000 square metres. Asset: loaded in milliseconds. Script: " +
                 "a script calls Begin.")]
        public NavMeshSource navMeshSource = NavMeshSource.SceneMeshes;
        [Tooltip("Scene Meshes: only those below this object. None: the whole scene this object is in.")]
        public Transform meshRoot;
        [Tooltip("Scene Meshes: only those in these layers.")]
        public LayerMask meshLayers = ~0;
        [Tooltip("Asset: a .fwmesh, imported with the ending .bytes.")]
        public TextAsset navMeshAsset;
        [Tooltip("Scene Meshes: how far the middle of the body stays from walls, metres.")]
        [Min(0f)]
        public float walkerRadius = 0.25f;
        [Tooltip("Scene Meshes: metres.")]
        [Min(0.1f)]
        public float walkerHeight = 1.8f;
        [Tooltip("Scene Meshes: the highest step that is walked, metres.")]
        [Min(0f)]
        public float highestStep = 0.25f;
        [Tooltip("Scene Meshes: the steepest ground that is walked, degrees.")]
        [Range(0f, 89f)]
        public float steepestSlope = 45f;

        [Header("Room")]
        [Tooltip("Of the tracked room along x, about the tracking origin, metres.")]
        [Min(0f)]
        public float roomWidth = 4f;
        [Tooltip("Of the tracked room along z, about the tracking origin, metres.")]
        [Min(0f)]
        public float roomDepth = 4f;
        [Tooltip("The tracked room as a polygon (x, z) in the tracking system's coordinates, metres, " +
                 "either way round. In the place of width and depth; empty: those.")]
        public Vector2[] roomBorder;

        [Header("Steering")]
        [Tooltip("What picks the gains. S2C Predictive: published steer-to-center on predicted ways. " +
                 "Foresight: plans on them; the fewest resets.")]
        public Controller controller = Controller.S2CPredictive;
        [Tooltip("How far gains may go. Steinicke: what hardly anybody notices. Laboratory: stronger " +
                 "curves, fewer resets. Custom: as Configure says.")]
        public GainLimits limits = GainLimits.Steinicke;
        [Tooltip("How far ahead ways are predicted, metres along the virtual path.")]
        [Range(1f, 100f)]
        public float horizon = 10f;
        [Tooltip("Polygon: as published. Front: real junctions, whatever the polygons.")]
        public PredictionMethod method = PredictionMethod.Polygon;
        [Tooltip("Name the ways ahead and how likely each is, for scripts that look at Session.Graph. Off: " +
                 "only where the controller asks for it.")]
        public bool likelihoods = false;
        [Tooltip("Stop the user at the room's border and turn them. Off: somebody else takes care.")]
        public bool resets = true;
        [Tooltip("How a reset turns the user.")]
        public ResetMethod reset = ResetMethod.TwoOneTurn;

        [Header("Console")]
        [Tooltip("What the library tells in Unity's console, for all rigs.")]
        public LogLevel log = LogLevel.Warning;

        [Header("Events")]
        [Tooltip("When there is something else to tell the user than before; None: nothing any more.")]
        public ResetPromptEvent resetPromptChanged = new ResetPromptEvent();

        /// <summary>Has the last word on the settings of each session: shared rooms, pillars, gains of
        /// your own.</summary>
        public Action<SessionSettings> Configure { get; set; }

        /// <summary>This walk; null before it begins. For gaze, teleports, the graph; the rig itself
        /// calls Frame.</summary>
        public ForewalkSession Session { get; private set; }

        /// <summary>What to tell the user now.</summary>
        public ResetPrompt Prompt { get; private set; }

        private double seconds;

        /// <summary>Begins a walk on this navmesh, in the place of the one before.</summary>
        /// <exception cref="ForewalkException">The sentence says what cannot work.</exception>
        public void Begin(ForewalkNavMesh navmesh)
        {
            Begin(settings => new ForewalkSession(navmesh, settings));
        }

        /// <summary>Begins a walk in a world that moves, in the place of the one before.</summary>
        public void Begin(ForewalkWorld world)
        {
            Begin(settings => new ForewalkSession(world, settings));
        }

        /// <summary>Puts the user at another place of the scene's floor, looking along `heading`:
        /// degrees, 0 is +Z, clockwise from above. The rig follows in its next LateUpdate.</summary>
        /// <exception cref="ForewalkException">More than 0.5 m off the floor; nothing
        /// changes.</exception>
        public void Teleport(Vector3 floor, float heading)
        {
            if (Session == null) throw new InvalidOperationException("The walk has not begun.");
            Session.Teleport(floor.ToForewalk(), heading * Mathf.Deg2Rad);
        }

        /// <summary>Builds a navmesh from the meshes of the scene as it stands, as the fields say,
        /// whatever the source. The caller's to dispose of.</summary>
        /// <exception cref="ForewalkException">Nothing walkable, and the like.</exception>
        public ForewalkNavMesh BuildNavMesh()
        {
            var triangles = new SceneTriangles();
            if (meshRoot != null)
            {
                triangles.Add(meshRoot.gameObject, meshLayers, transform);
            }
            else
            {
                foreach (GameObject root in gameObject.scene.GetRootGameObjects())
                {
                    triangles.Add(root, meshLayers, transform);
                }
            }
            foreach (string sentence in triangles.Skipped) Debug.LogWarning("forewalk: " + sentence, this);
            return ForewalkNavMesh.FromTriangles(triangles.Vertices, triangles.Indices,
                new BuildSettings {
                    Radius = walkerRadius,
                    Height = walkerHeight,
                    Climb = highestStep,
                    Slope = steepestSlope * Mathf.Deg2Rad
                });
        }

        private void LateUpdate()
        {
            if (Session == null && !TryBegin()) return;
            Advance();
        }

        private void OnDisable()
        {
            Session?.Dispose();
            Session = null;
            if (Prompt.Instruction != ResetInstruction.None)
            {
                Prompt = default;
                resetPromptChanged.Invoke(Prompt);
            }
        }

        private bool TryBegin()
        {
            if (navMeshSource == NavMeshSource.Script) return false;
            try
            {
                using (ForewalkNavMesh navmesh = NavMeshFromSource()) Begin(navmesh);
                return true;
            }
            catch (ForewalkException refusal)
            {
                Debug.LogError("forewalk: " + refusal.Message, this);
            }
            catch (DllNotFoundException)
            {
                Debug.LogError("forewalk: its library (libforewalk.so, forewalk.dll) is not in the " +
                               "project. See Install in the package's documentation.", this);
            }
            enabled = false;
            return false;
        }

        private ForewalkNavMesh NavMeshFromSource()
        {
            if (navMeshSource != NavMeshSource.Asset) return BuildNavMesh();
            if (navMeshAsset == null)
            {
                throw new ForewalkException(Status.ErrorArgument,
                    $"'{name}' is to walk on a navmesh asset, and there is none. Bake one, or choose " +
                    "Scene Meshes.");
            }
            return ForewalkNavMesh.FromFwmesh(navMeshAsset.bytes);
        }

        private void Begin(Func<SessionSettings, ForewalkSession> make)
        {
            ForewalkConsole.Show(log);
            if (head == null)
            {
                var camera = GetComponentInChildren<Camera>();
                head = camera == null ? null : camera.transform;
            }
            if (head == null || head == transform || !head.IsChildOf(transform))
            {
                throw new ForewalkException(Status.ErrorArgument,
                    $"'{name}' has no head below it. Put the Redirected Rig on the tracked camera's " +
                    "parent, or an object above it.");
            }
            Vector3 scale = head.lossyScale;
            if ((scale - Vector3.one).magnitude > 1e-3f)
            {
                throw new ForewalkException(Status.ErrorArgument,
                    $"The scale of '{head.name}' in the scene is {scale}. Steps would not be the body's: " +
                    "make it (1, 1, 1) all the way up.");
            }
            SessionSettings settings = SettingsFromHere();
            Configure?.Invoke(settings);
            ForewalkSession session = make(settings);
            Session?.Dispose();
            Session = session;
        }

        private SessionSettings SettingsFromHere()
        {
            ForewalkPose inRoom = HeadInRoom();
            Vector3 under = inRoom.Position.ToUnity();
            under.y = 0;
            // Above the place where the camera is now, looking where it looks: nothing jumps.
            Vector3 ahead = transform.rotation * inRoom.Orientation.ToUnity() * Vector3.forward;
            var settings = new SessionSettings {
                Controller = controller,
                Limits = limits,
                Horizon = horizon,
                Method = method,
                Likelihoods = likelihoods,
                Resets = resets,
                Reset = reset,
                StartFloor = (transform.position + transform.rotation * under).ToForewalk(),
                StartHeading = Mathf.Atan2(ahead.x, ahead.z)
            };
            if (roomBorder != null && roomBorder.Length > 0)
            {
                settings.Border = Array.ConvertAll(roomBorder, Conversions.ToForewalk);
            }
            else
            {
                settings.Width = roomWidth;
                settings.Depth = roomDepth;
            }
            return settings;
        }

        // The tracked head in the rig, that is in the room: through the objects between the two (an
        // offset for the height of the eyes), and not by way of the world, which would lose the last
        // bits far from its origin.
        private ForewalkPose HeadInRoom()
        {
            Vector3 position = head.localPosition;
            Quaternion orientation = head.localRotation;
            for (Transform above = head.parent; above != transform; above = above.parent)
            {
                position = above.localPosition + above.localRotation * position;
                orientation = above.localRotation * orientation;
            }
            return new ForewalkPose(position.ToForewalk(), orientation.ToForewalk());
        }

        private void Advance()
        {
            seconds += Time.unscaledDeltaTime;
            ForewalkPose inRoom = HeadInRoom();
            FrameOut frame = Session.Frame(inRoom, seconds);
            const FrameFlags lost = FrameFlags.PoseNotFinite | FrameFlags.OrientationUnusable;
            // From a head that is no pose no rig follows: it waits.
            if ((frame.Flags & lost) == 0) Place(frame.VirtualPose, inRoom);

            ResetInstruction before = Prompt.Instruction;
            Prompt = new ResetPrompt(frame, transform.rotation);
            if (Prompt.Instruction != before) resetPromptChanged.Invoke(Prompt);
        }

        // The rig's pose is the virtual head's, times the inverse of the head's in the rig.
        private void Place(in ForewalkPose virtualHead, in ForewalkPose inRoom)
        {
            Quaternion turn = virtualHead.Orientation.ToUnity() *
                              Quaternion.Inverse(inRoom.Orientation.ToUnity());
            // Redirection turns the room about the vertical alone; the rest is rounding.
            float length = Mathf.Sqrt(turn.y * turn.y + turn.w * turn.w);
            turn = new Quaternion(0f, turn.y / length, 0f, turn.w / length);
            transform.SetPositionAndRotation(
                virtualHead.Position.ToUnity() - turn * inRoom.Position.ToUnity(), turn);
        }
    }
}
