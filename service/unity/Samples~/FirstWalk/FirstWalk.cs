// A first walk without a headset: put this script on an empty object of an empty scene and press Play.
//
// It builds a hall of 16 x 16 m with a pillar, a rig with a camera, and somebody who walks around the
// pillar in a room of 5 x 5 m, doing what resets ask of them. With a headset none of this is needed:
// put a Redirected Rig on the tracked camera's parent.
using UnityEngine;

namespace Forewalk.Unity.Samples
{
    public sealed class FirstWalk : MonoBehaviour
    {
        [Tooltip("Of the made-up room, metres.")]
        public float room = 5f;
        [Tooltip("Metres per second.")]
        public float walkingSpeed = 1.1f;
        [Tooltip("On the spot, degrees per second.")]
        public float turnRate = 90f;
        [Tooltip("Of the laps around the pillar, metres.")]
        public float lapRadius = 5f;

        private RedirectedRig rig;
        private Transform body;
        private float heading;  // in the room, degrees, clockwise
        private float side = 1f;

        /// <summary>The rig that this script made.</summary>
        public RedirectedRig Rig => rig;

        private void Start()
        {
            Block("Floor", new Vector3(0f, -0.1f, 0f), new Vector3(16f, 0.2f, 16f));
            Block("Pillar", new Vector3(0f, 1.5f, 0f), new Vector3(4f, 3f, 4f));

            // What an XR Origin is in a real project: tracking moves the camera in it.
            var origin = new GameObject("Rig");
            origin.transform.position = new Vector3(-lapRadius, 0f, 0f);
            Camera camera = Camera.main;
            if (camera == null) camera = new GameObject("Camera").AddComponent<Camera>();
            body = camera.transform;
            body.SetParent(origin.transform, false);
            body.localPosition = new Vector3(0f, 1.7f, 0f);
            body.localRotation = Quaternion.identity;

            rig = origin.AddComponent<RedirectedRig>();
            rig.roomWidth = room;
            rig.roomDepth = room;
            rig.limits = GainLimits.Laboratory;
            rig.likelihoods = true;
            rig.log = LogLevel.Info;
            rig.resetPromptChanged.AddListener(prompt => Debug.Log("Prompt: " + prompt.Text));
        }

        private static void Block(string name, Vector3 middle, Vector3 size)
        {
            GameObject block = GameObject.CreatePrimitive(PrimitiveType.Cube);
            block.name = name;
            block.transform.position = middle;
            block.transform.localScale = size;
        }

        // Moves the body in the room, as tracking would.
        private void Update()
        {
            float seconds = Mathf.Min(Time.deltaTime, 0.1f);
            switch (rig.Prompt.Instruction)
            {
                case ResetInstruction.None:
                    Turn(Mathf.Clamp(2f * OffTheLap(), -60f, 60f) * seconds);
                    Walk(walkingSpeed * seconds);
                    break;
                case ResetInstruction.WalkBack:
                    Turn(Mathf.Clamp(4f * DegreesTo(body.localPosition * -1f),
                                     -turnRate, turnRate) * seconds);
                    Walk(0.5f * walkingSpeed * seconds);
                    break;
                case ResetInstruction.StepBack:
                    Walk(-0.5f * walkingSpeed * seconds);
                    break;
                case ResetInstruction.TurnLeft:
                    side = -1f;
                    Turn(side * turnRate * seconds);
                    break;
                case ResetInstruction.TurnRight:
                    side = 1f;
                    Turn(side * turnRate * seconds);
                    break;
                default:
                    Turn(side * turnRate * seconds);
                    break;
            }
        }

        private void LateUpdate()
        {
            if (rig.Session != null) DrawWays(rig.Session.Graph);
        }

        private void OnGUI()
        {
            GUI.Label(new Rect(Screen.width / 2 - 150, Screen.height / 2, 300, 30), rig.Prompt.Text);
        }

        // In the scene view: the ways ahead, the likelier the redder.
        private static void DrawWays(ForewalkGraph graph)
        {
            for (int i = 0; i < graph.Edges.Count; ++i)
            {
                Edge edge = graph.Edges[i];
                float likelihood = LikelihoodTo(graph, edge.To) + LikelihoodTo(graph, edge.From);
                Color color = Color.Lerp(Color.white, Color.red, likelihood);
                PointList path = graph.Path(edge);
                for (int p = 1; p < path.Count; ++p)
                {
                    Debug.DrawLine(path[p - 1].ToUnity(), path[p].ToUnity(), color);
                }
            }
        }

        private static float LikelihoodTo(ForewalkGraph graph, uint node)
        {
            for (int i = 0; i < graph.Ways.Count; ++i)
            {
                Way way = graph.Ways[i];
                if (way.Node == node) return way.Likelihood;
            }
            return 0f;
        }

        private void Turn(float degrees)
        {
            heading += degrees;
            body.localRotation = Quaternion.AngleAxis(heading, Vector3.up);
        }

        private void Walk(float metres)
        {
            body.localPosition += body.localRotation * Vector3.forward * metres;
        }

        // From where the body looks to a direction of the room, degrees, clockwise.
        private float DegreesTo(Vector3 direction)
        {
            Vector3 ahead = Quaternion.Inverse(body.localRotation) * direction;
            return Mathf.Atan2(ahead.x, ahead.z) * Mathf.Rad2Deg;
        }

        // How far somebody who sees the hall has to turn to stay on the lap, degrees, clockwise.
        private float OffTheLap()
        {
            Vector3 fromPillar = body.position;
            fromPillar.y = 0f;
            float distance = Mathf.Max(fromPillar.magnitude, 0.1f);
            // Clockwise around the pillar, and inward where the lap is left.
            var along = new Vector3(fromPillar.z, 0f, -fromPillar.x);
            float inward = Mathf.Clamp((distance - lapRadius) * 0.7f, -1f, 1f);
            Vector3 wanted = along - fromPillar * inward;
            Vector3 ahead = Quaternion.Inverse(body.rotation) * wanted;
            return Mathf.Atan2(ahead.x, ahead.z) * Mathf.Rad2Deg;
        }
    }
}
