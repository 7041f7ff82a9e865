using System;
using System.Collections.Generic;
using System.IO;
using Forewalk;

namespace Laws
{
    public static class Sessions
    {
        public static void DefaultsAreTheLibrarys()
        {
            var build = new BuildSettings();
            Check.That(build.MetresPerUnit == 1 && build.Height > build.Radius && build.Cell > 0 &&
                           !build.ZUp && build.Partition == Partition.Watershed, "build settings");
            var session = new SessionSettings();
            Check.That(session.Controller == Controller.S2CPredictive && session.Resets &&
                           session.AlwaysPredict && !session.Likelihoods && session.Horizon == 10 &&
                           session.PolygonLimit == 16384 && session.Persistence == 0.75f &&
                           session.TranslationMax > 1 && session.StartFloor == null, "session settings");
            var space = new SpaceSettings();
            Check.That(space.BodyRadius == 0.5f && space.UserLimit == 16, "space settings");
            Check.Equal(ForewalkLibrary.Version,
                        new Version(ForewalkLibrary.VersionMajor, ForewalkLibrary.VersionMinor,
                                    ForewalkLibrary.VersionPatch), "version");
        }

        public static void HandlesEndOnce()
        {
            ForewalkNavMesh navmesh = Made.Hall();
            var session = new ForewalkSession(navmesh);
            navmesh.Dispose();
            navmesh.Dispose();
            session.Frame(Made.Head(0, 0, 0), 0);
            Check.That(session.Graph.Nodes.Count > 0, "a session does not need its navmesh object");
            session.Dispose();
            session.Dispose();
            Check.Throws<ObjectDisposedException>(() => session.Frame(Made.Head(0, 0, 0), 1), "");
            Check.Throws<ObjectDisposedException>(() => navmesh.Save(), "");
            Check.Throws<ObjectDisposedException>(() => { ForewalkGraph none = session.Graph; }, "");

            // Those that nobody disposes of are ended by the collector, with what they own: a hundred
            // users of a room of 64 places.
            using (var space = new ForewalkSpace(new SpaceSettings { UserLimit = 64, Width = 8, Depth = 8 }))
            using (ForewalkNavMesh hall = Made.Hall())
            {
                for (int round = 0; round < 3; ++round)
                {
                    Forget(hall, space, 60);
                    for (int i = 0; i < 3; ++i)
                    {
                        GC.Collect();
                        GC.WaitForPendingFinalizers();
                    }
                }
            }
        }

        private static void Forget(ForewalkNavMesh hall, ForewalkSpace space, int sessions)
        {
            // Deep enough that no stale word of the stack holds them.
            if (sessions > 40)
            {
                Forget(hall, space, 40);
                sessions -= 40;
            }
            for (int i = 0; i < sessions; ++i)
            {
                new ForewalkSession(hall, new SessionSettings { Controller = Controller.S2C,
                                                                Space = space })
                    .Frame(Made.Head(0, 0, 0), 0);
            }
        }

        public static void GraphsEndWithTheirFrame()
        {
            using (ForewalkNavMesh navmesh = Made.Hall())
            using (var session =
                       new ForewalkSession(navmesh, new SessionSettings { Likelihoods = true }))
            {
                Check.Equal(session.Graph.Nodes.Count, 0, "nodes before the first frame");
                session.Frame(Made.Head(0, 0, 0), 0);
                ForewalkGraph graph = session.Graph;
                NodeList nodes = graph.Nodes;
                EdgeList edges = graph.Edges;
                WayList ways = graph.Ways;
                Check.That(nodes.Count > 1 && edges.Count > 0 && ways.Count > 0, "an empty graph");
                Check.Equal((int)session.Latest.GraphNodes, nodes.Count, "nodes");
                Check.Equal(nodes[0].Kind, NodeKind.Source, "the first node");
                Check.Equal(nodes[0].Prev, uint.MaxValue, "before the source");
                double sum = graph.LikelihoodNone;
                for (int i = 0; i < ways.Count; ++i) sum += ways[i].Likelihood;
                Check.That(Math.Abs(sum - 1) < 1e-4, "likelihoods sum to " + sum);
                Edge edge = edges[0];
                PointList path = graph.Path(edge);
                Check.That(path.Count >= 2, "a path of less than two points");
                Check.Throws<ArgumentOutOfRangeException>(() => { Node none = nodes[nodes.Count]; },
                                                          "entries");
                Check.Throws<ArgumentOutOfRangeException>(() => { Node none = nodes[-1]; }, "entries");
                Check.Throws<ArgumentOutOfRangeException>(() => { Vec3 none = path[path.Count]; }, "");
                Check.Equal(graph.Fronts.Count, 0, "fronts of a graph by polygons");
                Check.Equal(graph.Width(0), 0f, "width of a graph by polygons");

                session.Frame(Made.Head(0.01, 0, 0), 0.01);
                Check.Equal(nodes.Count, 0, "nodes of a frame that is over");
                Check.Equal(path.Count, 0, "points of a frame that is over");
                Check.Throws<ArgumentOutOfRangeException>(() => { Node none = nodes[0]; }, "its graph again");
                Check.Throws<ArgumentOutOfRangeException>(() => graph.Width(0), "its graph again");
                Check.That(ReferenceEquals(session.Graph, graph) && nodes.Count > 1, "filled again");
                session.Dispose();
                Check.Equal(nodes.Count, 0, "nodes of a session that is over");
            }
        }

        public static void PolygonsLieOnTheFloor()
        {
            using (ForewalkNavMesh hall = Made.Hall(), islands = Made.Islands())
            {
                foreach (ForewalkNavMesh navmesh in new[] { hall, islands })
                {
                    Polygon[] polygons = navmesh.Polygons();
                    Check.Equal(polygons.Length, navmesh.PolygonCount, "polygons");
                    for (int i = 0; i < polygons.Length; ++i)
                    {
                        Check.Equal(polygons[i].Triangles.Length % 3, 0, "corners of triangles");
                        // Unity's axes, from above: x to the right, z up.
                        double area = 0, covered = 0;
                        Vec3[] corners = polygons[i].Corners, triangles = polygons[i].Triangles;
                        for (int k = 0; k < corners.Length; ++k)
                        {
                            Vec3 a = corners[k], b = corners[(k + 1) % corners.Length];
                            area += 0.5 * (a.X * b.Z - a.Z * b.X);
                            Check.That(Math.Abs(a.Y) < 0.1, "a corner at " + a.Y + " m");
                        }
                        for (int k = 0; k < triangles.Length; k += 3)
                        {
                            Vec3 a = triangles[k], b = triangles[k + 1], c = triangles[k + 2];
                            covered += 0.5 * ((b.X - a.X) * (c.Z - a.Z) - (b.Z - a.Z) * (c.X - a.X));
                        }
                        Check.That(area > 0 && Math.Abs(area - covered) < 1e-3 * (1 + area),
                                   "triangles cover " + covered + " of " + area + " m^2");
                        foreach (Portal portal in polygons[i].Portals)
                        {
                            Check.That(Array.Exists(polygons[portal.To].Portals, back => back.To == i),
                                       "no way back");
                        }
                    }
                }
            }
        }

        public static void ErrorsAreSentences(string folder)
        {
            string missing = Path.Combine(folder, "Gebäude.obj");
            ForewalkException refusal = Check.Throws<ForewalkException>(
                () => ForewalkNavMesh.FromFile(missing), "Gebäude.obj");
            Check.Equal(refusal.Status, Status.ErrorFileUnreadable, "status");
            Check.Equal(Check.Throws<ForewalkException>(
                            () => ForewalkNavMesh.FromTriangles(Made.Floor, new[] { 0, 1, -1 }), "").Status,
                        Status.ErrorDataDamaged, "status of an index that is none");
            Check.Throws<ForewalkException>(() => ForewalkNavMesh.FromFwmesh(new byte[0]), "");
            using (ForewalkNavMesh navmesh = Made.Hall())
            {
                Check.Throws<ForewalkException>(
                    () => new ForewalkSession(navmesh, new SessionSettings { Horizon = -1 }), "horizon");
                refusal = Check.Throws<ForewalkException>(
                    () => new ForewalkSession(
                        navmesh, new SessionSettings { StartFloor = new Vec3(30, 0, 0) }), "30");
                Check.Equal(refusal.Status, Status.ErrorPositionOffNavMesh, "status");
                byte[] bytes = navmesh.Save();
                using (ForewalkNavMesh again = ForewalkNavMesh.FromFwmesh(bytes))
                {
                    Check.Equal(again.PolygonCount, navmesh.PolygonCount, "polygons");
                    Check.Equal(Convert.ToBase64String(again.Save()), Convert.ToBase64String(bytes),
                                "bytes of a navmesh");
                }
                string file = Path.Combine(folder, "Höhle.fwmesh");
                File.WriteAllBytes(file, bytes);
                using (ForewalkNavMesh again = ForewalkNavMesh.FromFile(file))
                {
                    Check.Equal(again.PolygonCount, navmesh.PolygonCount, "polygons from a file");
                }
                bytes[bytes.Length / 2] ^= 0x40;
                Check.Equal(
                    Check.Throws<ForewalkException>(() => ForewalkNavMesh.FromFwmesh(bytes), "").Status,
                    Status.ErrorDataDamaged, "status of a flipped bit");
                using (var session = new ForewalkSession(navmesh))
                {
                    Check.Throws<ForewalkException>(() => session.Teleport(new Vec3(0, 5, 0), 0), "5.0");
                    Check.Throws<ForewalkException>(() => session.Teleport(new Vec3(), float.NaN), "");
                }
            }
            Check.Throws<ArgumentNullException>(() => new ForewalkSession((ForewalkNavMesh)null), "");
        }

        public static void TakeWhatTheyAreTold()
        {
            using (ForewalkNavMesh navmesh = Made.Islands())
            using (var session = new ForewalkSession(navmesh, new SessionSettings {
                       StartFloor = new Vec3(2, 0, 2), Horizon = 20,
                       StartHeading = (float)(Math.PI / 2), HeadingSource = HeadingSource.Chest }))
            {
                ForewalkPose head = Made.Head(0, 0, 0);
                FrameOut frame = session.Frame(head, 0);
                Check.That(frame.Flags.HasFlag(FrameFlags.FirstFrame), "flags of the first frame");
                Check.That(Math.Abs(frame.VirtualPose.Position.X - 2) < 1e-5 &&
                               Math.Abs(frame.VirtualPose.Position.Z - 2) < 1e-5, "the start");
                Check.That(Math.Abs(frame.VirtualPose.Orientation.Y - Math.Sqrt(0.5)) < 1e-5,
                           "a heading of +90 degrees looks along +X");
                Check.That(FarthestX(session) < 4.1, "the other room");
                session.SetLinks(new Link(3, new Vec3(1, 0, 1), new Vec3(13, 0, 1), 2.5f));
                session.Frame(head, 0.1);
                Check.That(FarthestX(session) > 10, "the link's room");
                session.SetLinks(
                    new Link(3, new Vec3(1, 0, 1), new Vec3(13, 0, 1), 2.5f, false, true));
                session.Frame(head, 0.2);
                Check.That(FarthestX(session) < 4.1, "a closed link");
                session.SetLinks();
                session.SetStanding(new Standing(new Vec3(1, 0, 1), 0.5f));
                session.SetStanding(null);
                session.SetChest(new Vec3(1, 0, 0));
                session.SetGaze(new Vec3(1, 0, 0));
                session.SetGaze(null);
                session.Teleport(new Vec3(12, 0, 2), 0);
                frame = session.Frame(head, 0.3);
                Check.That(Math.Abs(frame.VirtualPose.Position.X - 12) < 1e-5, "the teleport");
                using (ForewalkNavMesh other = Made.Hall())
                {
                    session.Enter(other);
                }
                frame = session.Frame(head, 0.4);
                Check.That(frame.Flags.HasFlag(FrameFlags.GroundTaken), "another world");
                frame = session.Frame(new ForewalkPose(new Vec3(float.NaN, 0, 0), head.Orientation), 0.5);
                Check.That(frame.Flags.HasFlag(FrameFlags.PoseNotFinite) &&
                               !float.IsNaN(frame.VirtualPose.Position.X), "a pose that is none");
            }
        }

        /// <summary>A line a frame, under the name that was asked for; `forewalk replay` is tested with the
        /// C interface.</summary>
        public static void RecordingsAreWritten(string folder)
        {
            string file = Path.Combine(folder, "Spaziergang_ä.jsonl");
            using (ForewalkNavMesh navmesh = Made.Hall())
            using (var session = new ForewalkSession(navmesh))
            {
                Check.Equal(Check.Throws<ForewalkException>(
                                () => session.Record(Path.Combine(folder, "none", "walk")), "").Status,
                            Status.ErrorFileUnwritable, "status");
                var walker = new Walker();
                for (int i = 0; i < 100; ++i)
                {
                    if (i == 10) session.Record(file);
                    if (i == 60) session.Record(null);
                    session.Frame(walker.Step(i, false), i / 90.0);
                }
            }
            int lines = File.ReadAllLines(file).Length;
            Check.That(lines >= 50 && lines <= 55, $"{lines} lines for 50 frames");
        }

        private static double FarthestX(ForewalkSession session)
        {
            double farthest = double.MinValue;
            NodeList nodes = session.Graph.Nodes;
            for (int i = 0; i < nodes.Count; ++i) farthest = Math.Max(farthest, nodes[i].Position.X);
            return farthest;
        }

        public static void LogTells()
        {
            var told = new List<string>();
            ForewalkLog.Listen((level, message) => told.Add(level + " " + message), LogLevel.Info);
            GC.Collect();
            using (ForewalkNavMesh navmesh = Made.Hall())
            using (var session = new ForewalkSession(navmesh))
            {
                session.Frame(Made.Head(0, 0, 0), 0);
                session.Frame(Made.Head(0, 0, 0), 9);
                Check.Throws<ForewalkException>(() => session.Teleport(new Vec3(0, 5, 0), 0), "");
                string all = string.Join("\n", told.ToArray());
                Check.That(all.Contains("Info ") && all.Contains("Warning session") &&
                               all.Contains("Error forewalk_session_teleport"), all);
                int before = told.Count;
                ForewalkLog.Listen((level, message) => { throw new Exception("a listener's own"); },
                                   LogLevel.Info);
                Check.Throws<ForewalkException>(() => session.Teleport(new Vec3(0, 5, 0), 0), "");
                ForewalkLog.Listen(null, LogLevel.Info);
                Check.Throws<ForewalkException>(() => session.Teleport(new Vec3(0, 5, 0), 0), "");
                Check.Equal(told.Count, before, "told by a log that is off");
            }
        }
    }
}
