// Frames leave no garbage: what a collector has to clean up stalls a headset.
using System;
using System.Reflection;
using Forewalk;
using Forewalk.Unity;
using UnityEngine;

namespace Laws
{
    public static class Garbage
    {
        // Counts every byte that this thread allocates. Of .NET Core; Mono has it, too.
        private static readonly Func<long> allocated = (Func<long>)Delegate.CreateDelegate(
            typeof(Func<long>),
            typeof(GC).GetMethod("GetAllocatedBytesForCurrentThread",
                                 BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic));

        private const int Frames = 10000;
        internal static object Kept;

        public static void IsNotMade()
        {
            using (ForewalkNavMesh navmesh = Made.Hall())
            {
                foreach (PredictionMethod method in new[] { PredictionMethod.Polygon,
                                                            PredictionMethod.Front })
                {
                    using (var session = new ForewalkSession(
                               navmesh, new SessionSettings { Method = method, Horizon = 20,
                                                          Likelihoods = true }))
                    {
                        var walker = new Walker();
                        int at = 0;
                        double seen = 0;
                        Action<bool> walk = withObject => {
                            for (int end = at + Frames; at < end; ++at)
                            {
                                seen += Step(session, ref walker, at);
                                if (withObject) Kept = new object();
                            }
                        };
                        walk(false);  // what is compiled and grown the first time
                        long[] bytes = { Bytes(() => walk(false)), Bytes(() => walk(true)) };
                        Console.WriteLine($"{method}: {Frames} frames with their graphs, " +
                                          $"{session.Latest.ResetCount} resets: {bytes[0]} bytes; with an " +
                                          $"object a frame: {bytes[1]}");
                        Check.That(session.Latest.ResetCount > 0 && seen > 0, "nothing was walked");
                        Check.Equal(bytes[0], 0, "bytes of garbage");
                        Check.That(bytes[1] >= 16 * Frames, "the measure does not see an object a frame");
                    }
                }
            }
            RigsMakeNone();
        }

        private static void RigsMakeNone()
        {
            Stub.Clear();
            RedirectedRig rig = Rigs.HallWithRig(Vector3.zero, 0, out Transform camera);
            rig.log = LogLevel.Off;
            var walker = new Walker();
            int at = 0;
            Action walk = () => {
                for (int end = at + Frames; at < end; ++at)
                {
                    Rigs.Track(camera, walker.Step(at, rig.Session?.Latest.IsResetting ?? false));
                    Stub.Frame(1f / 90);
                }
            };
            walk();
            long bytes = Bytes(walk);
            Console.WriteLine($"rig: {Frames} frames, {rig.Session.Latest.ResetCount} resets: {bytes} bytes");
            Check.Equal(bytes, 0, "bytes of garbage of a rig");
        }

        private static long Bytes(Action action)
        {
            long before = allocated();
            action();
            return allocated() - before;
        }

        // A frame, and all of its graph looked at.
        private static double Step(ForewalkSession session, ref Walker walker, int at)
        {
            session.Frame(walker.Step(at, session.Latest.IsResetting), at / 90.0);
            if (at % 3 == 0) session.SetGaze(new Vec3(0, 0, 1));
            ForewalkGraph graph = session.Graph;
            double seen = 0;
            for (int i = 0; i < graph.Nodes.Count; ++i) seen += graph.Nodes[i].Distance;
            for (int i = 0; i < graph.Ways.Count; ++i) seen += graph.Ways[i].Likelihood;
            for (int i = 0; i < graph.Edges.Count; ++i)
            {
                PointList path = graph.Path(graph.Edges[i]);
                for (int p = 0; p < path.Count; ++p) seen += path[p].X * path[p].X;
            }
            return seen;
        }
    }
}
