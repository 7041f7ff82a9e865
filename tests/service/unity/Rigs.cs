// The rig in the stand-in's scenes, and the sample.
using System;
using System.Collections.Generic;
using System.Linq;
using Forewalk;
using Forewalk.Unity;
using Forewalk.Unity.Editing;
using Forewalk.Unity.Samples;
using UnityEngine;

namespace Laws
{
    public static class Rigs
    {
        /// <summary>A hall of 16 m x 16 m about the origin, and a rig in it with a camera 1.7 m above
        /// its floor.</summary>
        public static RedirectedRig HallWithRig(Vector3 place, float heading, out Transform camera)
        {
            GameObject floor = GameObject.CreatePrimitive(PrimitiveType.Cube);
            floor.transform.position = new Vector3(0, -0.1f, 0);
            floor.transform.localScale = new Vector3(16, 0.2f, 16);
            var origin = new GameObject("Rig");
            origin.transform.SetPositionAndRotation(place, Quaternion.AngleAxis(heading, Vector3.up));
            camera = new GameObject("Camera").AddComponent<Camera>().transform;
            camera.SetParent(origin.transform, false);
            camera.localPosition = new Vector3(0, 1.7f, 0);
            RedirectedRig rig = origin.AddComponent<RedirectedRig>();
            rig.log = LogLevel.Off;
            return rig;
        }

        /// <summary>What a tracking driver does.</summary>
        public static void Track(Transform camera, ForewalkPose head)
        {
            camera.localPosition = head.Position.ToUnity();
            camera.localRotation = head.Orientation.ToUnity();
        }

        private static float Apart(Vector3 a, Vector3 b) => (a - b).magnitude;

        // Radians. By the sine, which small angles need.
        private static float Apart(Quaternion a, Quaternion b)
        {
            Quaternion turn = Quaternion.Inverse(a) * b;
            return (float)(2 * Math.Asin(Math.Min(1, new Vector3(turn.x, turn.y, turn.z).magnitude)));
        }

        public static void PutTheCameraAtTheVirtualPose()
        {
            foreach (bool isNested in new[] { false, true })
            {
                Stub.Clear();
                RedirectedRig rig = HallWithRig(new Vector3(2, 0, -1), 130, out Transform camera);
                rig.controller = Controller.S2OPredictive;
                rig.limits = GainLimits.Laboratory;
                if (isNested)
                {
                    // As an XR Origin: an offset between, and the whole on something that moves.
                    Transform offset = new GameObject("Offset").transform;
                    offset.SetParent(rig.transform, false);
                    offset.localPosition = new Vector3(0.3f, 0.2f, -0.1f);
                    offset.localRotation = Quaternion.AngleAxis(20, Vector3.up);
                    camera.SetParent(offset, false);
                    Transform platform = new GameObject("Platform").transform;
                    platform.SetPositionAndRotation(new Vector3(-3, 1, 5), Quaternion.AngleAxis(-70, Vector3.up));
                    rig.transform.SetParent(platform);
                }
                Vector3 placed = rig.transform.position;
                Quaternion turned = rig.transform.rotation;

                var walker = new Walker();
                float worst = 0, worstAngle = 0, worstTilt = 0, turnedBy = 0;
                double walked = 0;
                Vector3 last = camera.position;
                for (int i = 0; i < 4000; ++i)
                {
                    ForewalkPose head = walker.Step(i, rig.Session?.Latest.IsResetting ?? false);
                    // Somebody who nods and tilts the head.
                    Quaternion nod = Quaternion.AngleAxis(15 * Mathf.Sin(0.05f * i), new Vector3(1, 0, 0)) *
                                     Quaternion.AngleAxis(6 * Mathf.Sin(0.03f * i), new Vector3(0, 0, 1));
                    head.Orientation = (head.Orientation.ToUnity() * nod).ToForewalk();
                    Track(camera, head);
                    Stub.Frame(1f / 90);
                    ForewalkPose wanted = rig.Session.Latest.VirtualPose;
                    worst = Math.Max(worst, Apart(camera.position, wanted.Position.ToUnity()));
                    worstAngle = Math.Max(worstAngle,
                                          Apart(camera.rotation, wanted.Orientation.ToUnity()));
                    Vector3 up = rig.transform.rotation * Vector3.up;
                    worstTilt = Math.Max(worstTilt, Apart(up, Vector3.up));
                    turnedBy = Math.Max(turnedBy, Apart(rig.transform.rotation, turned));
                    walked += Apart(camera.position, last);
                    last = camera.position;
                    if (i == 0)
                    {
                        Check.That(Apart(rig.transform.position, placed) < 1e-4f &&
                                       Apart(rig.transform.rotation, turned) < 1e-4f,
                                   "the rig jumps when it begins");
                    }
                }
                Console.WriteLine($"{(isNested ? "nested" : "plain")}: camera off by {worst:E1} m, " +
                                  $"{worstAngle:E1} rad at most; {rig.Session.Latest.ResetCount} resets, " +
                                  $"{walked:F0} m walked");
                Check.That(worst < 1e-4f, $"the camera is {worst} m beside the virtual pose");
                Check.That(worstAngle < 1e-5f, $"the camera is turned by {worstAngle} rad");
                Check.That(worstTilt < 1e-4f, "the rig leans");
                Check.That(rig.Session.Latest.ResetCount > 0 && turnedBy > 0.5f && walked > 10,
                           "nobody was redirected");
            }
        }

        public static void WaitForAPose()
        {
            Stub.Clear();
            RedirectedRig rig = HallWithRig(new Vector3(1, 0, 1), 40, out Transform camera);
            for (int i = 0; i < 20; ++i)
            {
                Track(camera, Made.Head(0, 0.01 * i, 0));
                Stub.Frame(1f / 90);
            }
            Vector3 place = rig.transform.position;
            Quaternion turn = rig.transform.rotation;
            ForewalkPose sound = Made.Head(0, 0.2, 0);
            var lost = new[] { new ForewalkPose(new Vec3(float.NaN, 0, 0), sound.Orientation),
                               new ForewalkPose(sound.Position, new Quat(0, 0, 0, 0)) };
            foreach (ForewalkPose pose in lost)
            {
                Track(camera, pose);
                Stub.Frame(1f / 90);
                Check.That(Apart(rig.transform.position, place) == 0 &&
                               Apart(rig.transform.rotation, turn) == 0, "the rig moves with a lost pose");
            }
            Track(camera, sound);
            Stub.Frame(1f / 90);
            Check.That(Apart(camera.position, rig.Session.Latest.VirtualPose.Position.ToUnity()) < 1e-4f,
                       "the rig goes on when the pose is back");
        }

        public static void BeginAndEnd()
        {
            Stub.Clear();
            RedirectedRig rig = HallWithRig(new Vector3(1, 0, 1), 0, out Transform camera);
            rig.log = LogLevel.Info;
            rig.controller = Controller.None;
            var prompts = new List<string>();
            rig.resetPromptChanged.AddListener(prompt => prompts.Add(prompt.Instruction.ToString()));
            SessionSettings configured = null;
            rig.Configure = settings => configured = settings;
            Action<int> walkTo = frames => {
                for (int i = 0; i < frames; ++i)
                {
                    Track(camera, Made.Head(0, i / 90.0, 0));
                    Stub.Frame(1f / 90);
                }
            };
            walkTo(1);
            Check.That(rig.Session != null && configured != null && configured.Width == 4, "begun");
            walkTo(200);
            Check.Equal(string.Join(" ", prompts.ToArray()), "TurnAround", "prompts");
            Check.That(rig.Prompt.Text.StartsWith("Stop") && rig.Prompt.DegreesLeft > 170, "the prompt");
            // Back, in the scene as the rig stands: it was turned by nothing, since nobody steers.
            Check.That(Apart(rig.Prompt.Direction, new Vector3(0, 0, -1)) < 0.05f, "its direction");
            Check.That(Stub.Console.Any(line => line.StartsWith("log: forewalk: ")), "the console");

            Vector3 place = camera.position;
            rig.enabled = false;
            Check.That(rig.Session == null && prompts.Last() == "None", "ended");
            Stub.Frame(1f / 90);
            Check.That(Apart(camera.position, place) == 0, "a rig that is off moves");
            rig.enabled = true;
            Stub.Frame(1f / 90);
            Check.That(rig.Session != null && Apart(camera.position, place) < 1e-4f, "begun anew");

            rig.Teleport(new Vector3(-5, 0, -5), 90);
            Stub.Frame(1f / 90);
            Check.That(Apart(camera.position, new Vector3(-5, 1.7f, -5)) < 1e-4f, "the teleport");
            Check.That(Apart(camera.rotation, Quaternion.AngleAxis(90, Vector3.up)) < 1e-3f, "its heading");
            Check.Throws<ForewalkException>(() => rig.Teleport(new Vector3(50, 0, 0), 0), "50");

            // From a script, in a world that moves.
            using (ForewalkWorld world = ForewalkWorld.FromTriangles(Made.Floor, Made.FloorTriangles))
            {
                rig.Begin(world);
                Stub.Frame(1f / 90);
                Check.That(rig.Session.Latest.GraphNodes > 1, "in a world");
            }

            Refuses("scale", some => some.transform.localScale = new Vector3(2, 2, 2));
            Refuses("no head below it", some => some.head = some.transform);
            Refuses("there is none", some => some.navMeshSource = NavMeshSource.Asset);
            Refuses("horizon", some => some.horizon = -1);
            Refuses("start", some => some.transform.position = new Vector3(40, 0, 0));

            Stub.Clear();
            rig = HallWithRig(Vector3.zero, 0, out camera);
            rig.navMeshSource = NavMeshSource.Script;
            Stub.Frame(1f / 90);
            Check.That(rig.enabled && rig.Session == null, "waits for a script");
            using (ForewalkNavMesh hall = Made.Hall()) rig.Begin(hall);
            Stub.Frame(1f / 90);
            Check.That(rig.Session.Latest.GraphNodes > 1, "begun by a script");
        }

        private static void Refuses(string saying, Action<RedirectedRig> spoil)
        {
            Stub.Clear();
            RedirectedRig rig = HallWithRig(Vector3.zero, 0, out Transform camera);
            spoil(rig);
            Stub.Frame(1f / 90);
            Stub.Frame(1f / 90);
            string[] errors = Stub.Console.Where(line => line.StartsWith("error: ")).ToArray();
            Check.That(errors.Length == 1 && errors[0].Contains(saying),
                       $"'{saying}' in one error: {string.Join("; ", errors)}");
            Check.That(!rig.enabled && rig.Session == null, "a rig that cannot begin is off");
        }

        public static void ReadTheScene(string folder)
        {
            // The same floor: plain, mirrored, as one of many in a root, in another layer too.
            int polygons = PolygonsOf(rig => {});
            Check.That(polygons > 0, "no polygon");
            Check.Equal(PolygonsOf(rig => Floor().localScale = new Vector3(-16, 0.2f, 16)), polygons,
                        "polygons of a mirrored floor");
            Check.Equal(PolygonsOf(rig => {
                // A box under the rig is nobody's floor or wall.
                GameObject hand = GameObject.CreatePrimitive(PrimitiveType.Cube);
                hand.transform.SetParent(rig.transform, false);
            }), polygons, "polygons with a hand");
            Check.Equal(PolygonsOf(rig => {
                GameObject table = GameObject.CreatePrimitive(PrimitiveType.Cube);
                table.layer = 5;
                rig.meshLayers = ~(1 << 5);
            }), polygons, "polygons with a layer left out");
            Check.Equal(PolygonsOf(rig => GameObject.CreatePrimitive(PrimitiveType.Cube).SetActive(false)),
                        polygons, "polygons with what is not there");
            Check.That(PolygonsOf(rig => GameObject.CreatePrimitive(PrimitiveType.Cube)) > polygons,
                       "a box takes floor");
            Check.Equal(PolygonsOf(rig => {
                GameObject.CreatePrimitive(PrimitiveType.Cube);
                Transform floor = Floor();
                rig.meshRoot = new GameObject("Building").transform;
                floor.SetParent(rig.meshRoot);
            }), polygons, "polygons below a root");

            // What cannot be read is named, and the rest is built.
            Check.Equal(PolygonsOf(rig => {
                MeshFilter locked = GameObject.CreatePrimitive(PrimitiveType.Cube).GetComponent<MeshFilter>();
                locked.name = "Locked";
                locked.sharedMesh.isReadable = false;
                GameObject batched = GameObject.CreatePrimitive(PrimitiveType.Cube);
                batched.GetComponent<MeshRenderer>().isPartOfStaticBatch = true;
                batched.name = "Batched";
                new GameObject("Lines").AddComponent<MeshFilter>().sharedMesh =
                    Stub.MeshOf("Lines", new[] { Vector3.zero, Vector3.up }, new[] { 0, 1 });
                new GameObject("Nothing").AddComponent<MeshFilter>();
            }), polygons, "polygons beside what cannot be read");
            string said = string.Join("\n", Stub.Console.ToArray());
            Check.That(said.Contains("'Locked'") && said.Contains("Read/Write") &&
                           said.Contains("'Batched'") && !said.Contains("Lines"), said);

            // Baked, and loaded again, where there is no floor any more.
            Stub.Clear();
            RedirectedRig baked = HallWithRig(Vector3.zero, 0, out Transform camera);
            string file = System.IO.Path.Combine(folder, "hall.fwmesh.bytes");
            RedirectedRigEditor.BakeTo(baked, file);
            Check.That(baked.navMeshSource == NavMeshSource.Asset && baked.navMeshAsset != null, "baked");
            Floor().gameObject.SetActive(false);
            Stub.Frame(1f / 90);
            Check.That(baked.Session != null && baked.Session.Latest.GraphNodes > 1, "a baked navmesh");
        }

        private static Transform Floor() => Stub.Objects[0].transform;

        private static int PolygonsOf(Action<RedirectedRig> change)
        {
            Stub.Clear();
            RedirectedRig rig = HallWithRig(Vector3.zero, 0, out Transform camera);
            change(rig);
            using (ForewalkNavMesh navmesh = rig.BuildNavMesh()) return navmesh.PolygonCount;
        }

        public static void ShowTheLibrarysDefaults()
        {
            Stub.Clear();
            RedirectedRig rig = HallWithRig(Vector3.zero, 0, out Transform camera);
            var build = new BuildSettings();
            Check.Equal(rig.walkerRadius, build.Radius, "radius");
            Check.Equal(rig.walkerHeight, build.Height, "height");
            Check.Equal(rig.highestStep, build.Climb, "step");
            Check.That(Math.Abs(rig.steepestSlope * Mathf.Deg2Rad - build.Slope) < 1e-6, "slope");
            var session = new SessionSettings();
            Check.Equal(rig.controller, session.Controller, "controller");
            Check.Equal(rig.limits, session.Limits, "limits");
            Check.Equal(rig.horizon, session.Horizon, "horizon");
            Check.Equal(rig.method, session.Method, "method");
            Check.Equal(rig.likelihoods, session.Likelihoods, "likelihoods");
            Check.Equal(rig.resets, session.Resets, "resets");
            Check.Equal(rig.reset, session.Reset, "reset");
        }

        public static void SampleStaysInItsRoom()
        {
            Stub.Clear();
            FirstWalk sample = new GameObject("Sample").AddComponent<FirstWalk>();
            float outermost = 0;
            double walked = 0;
            var laps = 0.0;
            Vector3? last = null;
            for (int i = 0; i < 90 * 120; ++i)
            {
                Stub.Frame(1f / 90);
                Transform camera = sample.Rig.head;
                Vector3 inRoom = camera.localPosition;
                outermost = Math.Max(outermost, Math.Max(Math.Abs(inRoom.x), Math.Abs(inRoom.z)));
                Vector3 now = camera.position;
                if (last.HasValue)
                {
                    Vector3 was = last.Value;
                    walked += Apart(now, was);
                    laps += Math.Atan2(now.x * was.z - now.z * was.x, now.x * was.x + now.z * was.z) /
                            (2 * Math.PI);
                }
                last = now;
            }
            uint resets = sample.Rig.Session.Latest.ResetCount;
            Console.WriteLine($"two minutes: {walked:F0} m walked, {laps:F1} laps, {resets} resets, at most " +
                              $"{outermost:F2} m from the middle of a room of 5 m");
            Check.That(walked > 60 && laps > 1.5 && resets > 0, "the sample does not walk");
            Check.That(outermost < 2.5f, "the sample leaves its room");
            Check.That(Stub.Lines > 1000, "no way is drawn");
            Check.That(Stub.Console.All(line => line.StartsWith("log: ")),
                       Stub.Console.FirstOrDefault(line => !line.StartsWith("log: ")) ?? "");
        }
    }
}
