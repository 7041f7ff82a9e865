// What the Unity package promises, checked in C# against the real library, under Mono. unity_test.cpp
// runs each law by its name; one that does not hold ends the program with a sentence and status 1.
using System;
using System.Collections.Generic;
using Forewalk;

namespace Laws
{
    public static class Check
    {
        public static void That(bool holds, string what)
        {
            if (!holds) throw new Exception(what);
        }

        public static void Equal<T>(T actual, T expected, string what)
        {
            That(EqualityComparer<T>.Default.Equals(actual, expected),
                 $"{what}: {actual}, expected {expected}");
        }

        /// <summary>The exception that `call` throws, whose message holds `saying`.</summary>
        public static E Throws<E>(Action call, string saying) where E : Exception
        {
            try
            {
                call();
            }
            catch (E thrown)
            {
                That(thrown.Message.Contains(saying), $"'{thrown.Message}' does not say '{saying}'");
                return thrown;
            }
            throw new Exception($"no {typeof(E).Name} that says '{saying}'");
        }
    }

    public static class Program
    {
        private static readonly Dictionary<string, Action<string[]>> laws =
            new Dictionary<string, Action<string[]>> {
                { "layout", arguments => Layout.Print(arguments[1]) },
                { "walk", arguments => Walks.Walk(arguments[1], arguments[2]) },
                { "garbage", _ => Garbage.IsNotMade() },
                { "defaults", _ => Sessions.DefaultsAreTheLibrarys() },
                { "handles", _ => Sessions.HandlesEndOnce() },
                { "graph", _ => Sessions.GraphsEndWithTheirFrame() },
                { "polygons", _ => Sessions.PolygonsLieOnTheFloor() },
                { "errors", arguments => Sessions.ErrorsAreSentences(arguments[1]) },
                { "calls", _ => Sessions.TakeWhatTheyAreTold() },
                { "spaces", _ => Rooms.AreShared() },
                { "worlds", _ => Rooms.WorldsMove() },
                { "record", arguments => Sessions.RecordingsAreWritten(arguments[1]) },
                { "log", _ => Sessions.LogTells() },
                { "rig", _ => Rigs.PutTheCameraAtTheVirtualPose() },
                { "rig-lost", _ => Rigs.WaitForAPose() },
                { "rig-life", _ => Rigs.BeginAndEnd() },
                { "rig-scene", arguments => Rigs.ReadTheScene(arguments[1]) },
                { "rig-defaults", _ => Rigs.ShowTheLibrarysDefaults() },
                { "page", arguments => Page.ScriptsDoWhatItSays(arguments[1]) },
                { "sample", _ => Rigs.SampleStaysInItsRoom() }
            };

        public static int Main(string[] arguments)
        {
            if (arguments.Length == 0 || !laws.ContainsKey(arguments[0]))
            {
                Console.Error.WriteLine("usage: unity_laws LAW, one of " + string.Join(" ", laws.Keys));
                return 2;
            }
            try
            {
                laws[arguments[0]](arguments);
                return 0;
            }
            catch (Exception broken)
            {
                Console.Error.WriteLine($"{arguments[0]}: {broken.Message}\n{broken}");
                return 1;
            }
        }
    }

    /// <summary>Scenes and users that several laws share, in Unity's axes.</summary>
    public static class Made
    {
        /// <summary>A floor of 16 m x 16 m around the origin.</summary>
        public static readonly Vec3[] Floor = { new Vec3(-8, 0, -8), new Vec3(-8, 0, 8),
                                                new Vec3(8, 0, 8), new Vec3(8, 0, -8) };
        public static readonly int[] FloorTriangles = { 0, 1, 2, 0, 2, 3 };

        public static ForewalkNavMesh Hall() => ForewalkNavMesh.FromTriangles(Floor, FloorTriangles);

        /// <summary>Two rooms of 4 m, 6 m apart along x, from (0, 0) on.</summary>
        public static ForewalkNavMesh Islands()
        {
            var vertices = new List<Vec3>();
            var indices = new List<int>();
            foreach (float x in new[] { 0f, 10f })
            {
                int first = vertices.Count;
                vertices.Add(new Vec3(x, 0, 0));
                vertices.Add(new Vec3(x, 0, 4));
                vertices.Add(new Vec3(x + 4, 0, 4));
                vertices.Add(new Vec3(x + 4, 0, 0));
                foreach (int corner in FloorTriangles) indices.Add(first + corner);
            }
            return ForewalkNavMesh.FromTriangles(vertices.ToArray(), indices.ToArray());
        }

        public static ForewalkPose Head(double x, double z, double heading)
        {
            return new ForewalkPose(new Vec3((float)x, 1.7f, (float)z),
                                    new Quat(0, (float)Math.Sin(heading / 2), 0,
                                             (float)Math.Cos(heading / 2)));
        }
    }

    /// <summary>Somebody who walks on in a wavy line, and in a reset turns to the right on the
    /// spot.</summary>
    public struct Walker
    {
        public double X, Z, Heading;

        public ForewalkPose Step(int frame, bool isResetting)
        {
            const double dt = 1.0 / 90;
            if (frame > 0)
            {
                if (isResetting)
                {
                    Heading += 1.5 * dt;
                }
                else
                {
                    Heading += 0.4 * Math.Cos(0.02 * frame) * dt;
                    X += 1.1 * dt * Math.Sin(Heading);
                    Z += 1.1 * dt * Math.Cos(Heading);
                }
            }
            return Made.Head(X, Z, Heading);
        }
    }
}
