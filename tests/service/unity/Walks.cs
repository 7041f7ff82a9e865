// A recorded walk, told to the package frame by frame. unity_test.cpp writes the file, and compares.
using System;
using System.IO;
using System.Runtime.InteropServices;
using Forewalk;

namespace Laws
{
    public static unsafe class Walks
    {
        /// <summary>Reads a scene, settings and heads; writes, for each frame, the FrameOut as it lies in
        /// memory and a hash of the graph as the accessors give it.</summary>
        public static void Walk(string input, string output)
        {
            using (var reader = new BinaryReader(File.OpenRead(input)))
            using (var writer = new BinaryWriter(File.Create(output)))
            {
                SessionSettings settings = ReadSettings(reader);
                using (ForewalkNavMesh navmesh = ReadNavMesh(reader))
                using (var session = new ForewalkSession(navmesh, settings))
                {
                    int frames = reader.ReadInt32();
                    for (int i = 0; i < frames; ++i)
                    {
                        var head = new ForewalkPose(ReadPoint(reader),
                                                    new Quat(reader.ReadSingle(), reader.ReadSingle(),
                                                             reader.ReadSingle(), reader.ReadSingle()));
                        FrameOut frame = session.Frame(head, reader.ReadDouble());
                        writer.Write(BytesOf(frame));
                        writer.Write(HashOf(session.Graph));
                    }
                    Console.WriteLine($"{frames} frames, {session.Latest.ResetCount} resets");
                }
            }
        }

        private static SessionSettings ReadSettings(BinaryReader reader)
        {
            return new SessionSettings {
                Controller = (Controller)reader.ReadInt32(),
                Limits = (GainLimits)reader.ReadInt32(),
                Method = (PredictionMethod)reader.ReadInt32(),
                Reset = (ResetMethod)reader.ReadInt32(),
                Horizon = reader.ReadSingle(),
                Width = reader.ReadSingle(),
                Depth = reader.ReadSingle(),
                StartFloor = ReadPoint(reader),
                StartHeading = reader.ReadSingle(),
                Likelihoods = true
            };
        }

        private static ForewalkNavMesh ReadNavMesh(BinaryReader reader)
        {
            var vertices = new Vec3[reader.ReadInt32()];
            for (int i = 0; i < vertices.Length; ++i) vertices[i] = ReadPoint(reader);
            var indices = new int[reader.ReadInt32()];
            for (int i = 0; i < indices.Length; ++i) indices[i] = reader.ReadInt32();
            return ForewalkNavMesh.FromTriangles(vertices, indices);
        }

        private static Vec3 ReadPoint(BinaryReader reader) =>
            new Vec3(reader.ReadSingle(), reader.ReadSingle(), reader.ReadSingle());

        private static byte[] BytesOf(FrameOut frame)
        {
            var bytes = new byte[sizeof(FrameOut)];
            Marshal.Copy((IntPtr)(&frame), bytes, 0, bytes.Length);
            return bytes;
        }

        /// <summary>FNV-1a over words; floats by their bits.</summary>
        private struct Hash
        {
            public ulong Value;
            public void Add(uint word) => Value = (Value ^ word) * 0x100000001b3ul;
            public void Add(float number) => Add(*(uint*)&number);
            public void Add(Vec3 point)
            {
                Add(point.X);
                Add(point.Y);
                Add(point.Z);
            }
        }

        private static ulong HashOf(ForewalkGraph graph)
        {
            var hash = new Hash { Value = 0xcbf29ce484222325ul };
            for (int i = 0; i < graph.Nodes.Count; ++i)
            {
                Node node = graph.Nodes[i];
                hash.Add(node.Position);
                hash.Add(node.Distance);
                hash.Add(node.Prev);
                hash.Add(node.Polygon);
                hash.Add((uint)node.Kind);
                hash.Add((uint)node.Reason);
                hash.Add(node.IsBranch ? 1u : 0u);
            }
            for (int i = 0; i < graph.Edges.Count; ++i)
            {
                Edge edge = graph.Edges[i];
                hash.Add(edge.From);
                hash.Add(edge.To);
                hash.Add(edge.Length);
                hash.Add(edge.IsLoop ? 1u : 0u);
                hash.Add(graph.Width(i));
                PointList path = graph.Path(edge);
                for (int p = 0; p < path.Count; ++p) hash.Add(path[p]);
            }
            for (int i = 0; i < graph.Points.Count; ++i) hash.Add(graph.Points[i]);
            for (int i = 0; i < graph.Fronts.Count; ++i)
            {
                Front front = graph.Fronts[i];
                hash.Add(front.Node);
                hash.Add(front.Length);
                hash.Add(front.From);
                hash.Add(front.To);
            }
            for (int i = 0; i < graph.Ways.Count; ++i)
            {
                Way way = graph.Ways[i];
                hash.Add(way.Id);
                hash.Add(way.Node);
                hash.Add(way.Likelihood);
                hash.Add(way.IsBorn ? 1u : 0u);
            }
            for (int i = 0; i < graph.WayEvents.Count; ++i)
            {
                WayEvent happened = graph.WayEvents[i];
                hash.Add(happened.Way);
                hash.Add(happened.Other);
                hash.Add((uint)happened.Change);
            }
            hash.Add(graph.Horizon);
            hash.Add(graph.CompleteTo);
            hash.Add(graph.LikelihoodNone);
            hash.Add((uint)graph.Method);
            return hash.Value;
        }
    }
}
