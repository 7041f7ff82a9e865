using System;
using System.Collections.Generic;
using Forewalk;

namespace Laws
{
    public static class Rooms
    {
        /// <summary>Two people who walk toward each other meet in rooms of their own, and do not in one
        /// that they share.</summary>
        public static void AreShared()
        {
            var plain = new[] { new Vec3(-30, 0, -30), new Vec3(-30, 0, 30), new Vec3(30, 0, 30),
                                new Vec3(30, 0, -30) };
            var room = new SpaceSettings { Width = 6, Depth = 12, UserLimit = 2 };
            using (ForewalkNavMesh navmesh = ForewalkNavMesh.FromTriangles(plain, Made.FloorTriangles))
            using (var shared = new ForewalkSpace(room))
            using (var mine = new ForewalkSpace(room))
            using (var yours = new ForewalkSpace(room))
            {
                double apart = Nearest(navmesh, shared, shared), alone = Nearest(navmesh, mine, yours);
                Console.WriteLine($"nearest in one room {apart:F2} m, in two {alone:F2} m");
                Check.That(apart > 0.5 && alone < 0.3, "people who share a room");
                var settings = new SessionSettings { Space = shared };
                using (new ForewalkSession(navmesh, settings))
                using (new ForewalkSession(navmesh, settings))
                {
                    Check.Throws<ForewalkException>(() => new ForewalkSession(navmesh, settings),
                                                    "user_limit");
                }
                settings.Width = 3;
                Check.Throws<ForewalkException>(() => new ForewalkSession(navmesh, settings),
                                                "Give one of the two");
                Check.Throws<ForewalkException>(
                    () => new ForewalkSpace(new SpaceSettings { BodyRadius = -1 }), "body_radius");
            }
            PillarsAreKeptClearOf();
        }

        private static double Nearest(ForewalkNavMesh navmesh, ForewalkSpace first, ForewalkSpace second)
        {
            var settings = new SessionSettings { Controller = Controller.S2C, Space = first };
            using (var a = new ForewalkSession(navmesh, settings))
            {
                settings.Space = second;
                using (var b = new ForewalkSession(navmesh, settings))
                {
                    var one = new Walker { Z = -4 };
                    var two = new Walker { X = 0.1, Z = 4, Heading = Math.PI };
                    double nearest = double.MaxValue;
                    for (int i = 0; i < 900; ++i)
                    {
                        a.Frame(one.Step(i, a.Latest.IsResetting), i / 90.0);
                        b.Frame(two.Step(i, b.Latest.IsResetting), i / 90.0);
                        nearest = Math.Min(nearest,
                                           Math.Sqrt(Math.Pow(one.X - two.X, 2) +
                                                     Math.Pow(one.Z - two.Z, 2)));
                    }
                    return nearest;
                }
            }
        }

        /// <summary>Who walks straight to a pillar of the room is stopped before it.</summary>
        private static void PillarsAreKeptClearOf()
        {
            var settings = new SessionSettings {
                Controller = Controller.None,
                Border = new[] { new Point2(-4, -4), new Point2(4, -4), new Point2(4, 4),
                                 new Point2(-4, 4) },
                Holes = new[] {
                    new[] { new Point2(-0.5f, 2), new Point2(0.5f, 2), new Point2(0.5f, 3),
                            new Point2(-0.5f, 3) },
                    new[] { new Point2(-3, -3), new Point2(-2, -3), new Point2(-2.5f, -2) }
                }
            };
            using (ForewalkNavMesh navmesh = Made.Hall())
            using (var session = new ForewalkSession(navmesh, settings))
            {
                double z = 0;
                for (int i = 0; i < 400 && !session.Latest.IsResetting; ++i)
                {
                    z = i / 90.0;
                    session.Frame(Made.Head(0, z, 0), i / 90.0);
                }
                Check.That(z > 1 && z < 2, $"stopped at {z:F2} m, the pillar begins at 2 m");
                Check.That(session.Latest.ResetPhase == ResetPhase.Turn &&
                               session.Latest.Instruction == ResetInstruction.TurnAround &&
                               session.Latest.ResetRemaining > 3, "what a reset says");
                Check.That(session.Latest.ResetDirection.Z < -0.99, "where it leads: back");
            }
        }

        /// <summary>A corridor of 12 m along x, from 0 on: its far end is in the graph unless something
        /// is in the way.</summary>
        public static void WorldsMove()
        {
            var corridor = new[] { new Vec3(0, 0, 0), new Vec3(0, 0, 2), new Vec3(12, 0, 2),
                                   new Vec3(12, 0, 0) };
            var doors = new[] { new Door { Id = 1, IsOpen = true, Corners = Strip(6, 6.5f) } };
            using (ForewalkWorld world =
                       ForewalkWorld.FromTriangles(corridor, Made.FloorTriangles, new BuildSettings(), doors))
            using (var session = new ForewalkSession(world, new SessionSettings {
                       StartFloor = new Vec3(1, 0, 1), Horizon = 20 }))
            {
                var farthest = new List<string>();
                double seconds = 0;
                Action<string, bool> expect = (what, isOpen) => {
                    world.Wait();
                    session.Frame(Made.Head(0, 0, 0), seconds += 0.01);
                    double x = 0;
                    for (int i = 0; i < session.Graph.Nodes.Count; ++i)
                    {
                        x = Math.Max(x, session.Graph.Nodes[i].Position.X);
                    }
                    farthest.Add($"{what} {x:F1}");
                    Check.That(isOpen == x > 8, string.Join(", ", farthest.ToArray()));
                };
                ulong version = world.Version;
                expect("open", true);
                doors[0].IsOpen = false;
                world.SetDoor(doors[0]);
                expect("door", false);
                doors[0].IsOpen = true;
                world.SetDoor(doors[0]);
                expect("door open", true);
                world.SetObstacles(
                    new Obstacle { Id = 7, Shape = ObstacleShape.Box, Position = new Vec3(4, 0.5f, 1),
                                   HalfSize = new Vec3(0.3f, 0.5f, 2) },
                    new Obstacle { Id = 8, Shape = ObstacleShape.Cylinder, Position = new Vec3(11, 0, 1),
                                   Radius = 0.2f, Height = 1 });
                expect("box", false);
                world.RemoveObstacle(7);
                expect("box gone", true);
                world.SetObstacles(new Obstacle { Id = 9, Shape = ObstacleShape.Prism, Height = 1,
                                                  Corners = Strip(3, 3.5f) });
                expect("prism", false);
                world.SetLink(new Link(1, new Vec3(2, 0, 1), new Vec3(9, 0, 1), 1));
                expect("link", true);
                world.RemoveLink(1);
                expect("link gone", false);
                world.RemoveObstacle(9);
                world.SetStanding(new Standing(new Vec3(6.25f, 0, 1), 1.2f));
                world.Wait();
                world.SetStanding();
                expect("all gone", true);
                Check.That(world.Version > version, "versions ascend");
                Check.Throws<ForewalkException>(
                    () => world.SetObstacles(new Obstacle { Id = 1, Shape = ObstacleShape.Cylinder,
                                                            Radius = -1, Height = 1 }), "");
                Check.Throws<ArgumentException>(() => world.SetObstacles(new Obstacle[1]), "Obstacle 0");
                Check.Throws<ArgumentNullException>(() => world.SetDoor(null), "");
                Console.WriteLine(string.Join(", ", farthest.ToArray()));
            }
        }

        private static Vec3[] Strip(float from, float to) => new[] {
            new Vec3(from, 0, -0.1f), new Vec3(to, 0, -0.1f), new Vec3(to, 0, 2.1f),
            new Vec3(from, 0, 2.1f)
        };
    }
}
