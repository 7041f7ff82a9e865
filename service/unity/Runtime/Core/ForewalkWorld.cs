using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Forewalk
{
    /// <summary>A door, or any part of the floor that opens, closes or costs more.</summary>
    public sealed class Door
    {
        public uint Id;
        /// <summary>As if it were not there.</summary>
        public bool IsOpen;
        /// <summary>A convex outline on the floor, 3 to 64 corners, either way round.</summary>
        public Vec3[] Corners;
        /// <summary>Floor up to so many metres over the lowest corner; 0: 2 metres.</summary>
        public float Height;
        /// <summary>Of one that is not open; 0: nobody goes through; else 1 to 1e6 metres for each
        /// metre.</summary>
        public float Cost;
    }

    /// <summary>Something that takes floor: furniture, a barrier, a robot. What a shape does not name is
    /// not read.</summary>
    public sealed class Obstacle
    {
        /// <summary>One of its own.</summary>
        public uint Id;
        public ObstacleShape Shape;
        /// <summary>Box: its middle; cylinder: the middle of its lower end.</summary>
        public Vec3 Position;
        /// <summary>Box, along the axes before it is turned, more than 0.</summary>
        public Vec3 HalfSize;
        /// <summary>Box, radians, positive to the right.</summary>
        public float Heading;
        /// <summary>Cylinder, metres, more than 0.</summary>
        public float Radius;
        /// <summary>Cylinder and prism, metres, more than 0.</summary>
        public float Height;
        /// <summary>Prism: of its lower end, 3 to 64, convex.</summary>
        public Vec3[] Corners;
    }

    /// <summary>Where one can walk while doors, obstacles and people come and go. Rebuilt on a thread of
    /// its own; the sessions made in it take the newest version in their next frame, without waiting.
    /// Sessions keep what they need of it, so it may be disposed of while they live.</summary>
    /// <remarks>Calls may be made on any thread, but not within a frame's time budget: they lock, and
    /// the lists they take are pinned.</remarks>
    public sealed unsafe class ForewalkWorld : IDisposable
    {
        internal readonly WorldHandle Handle;

        private ForewalkWorld(WorldHandle handle)
        {
            Handle = handle;
        }

        /// <summary>Builds from a scene file as <see cref="ForewalkNavMesh.FromFile"/>; a .fwmesh has
        /// nothing to build from again. `doors` are those that there will be: the floor is cut along
        /// their outlines.</summary>
        public static ForewalkWorld FromFile(string path, BuildSettings settings = null,
                                             Door[] doors = null)
        {
            byte[] bytes = ForewalkLibrary.BytesOf(path);
            using (var pinned = new PinnedWorld(settings, doors))
            {
                NativeWorldSettings native = pinned.Settings;
                fixed (byte* text = bytes)
                {
                    ForewalkLibrary.Check(
                        Native.forewalk_world_from_file(text, &native, out WorldHandle handle));
                    return new ForewalkWorld(handle);
                }
            }
        }

        /// <summary>Builds as <see cref="ForewalkNavMesh.FromTriangles"/>.</summary>
        public static ForewalkWorld FromTriangles(Vec3[] vertices, int[] indices,
                                                  BuildSettings settings = null, Door[] doors = null)
        {
            if (vertices == null) throw new ArgumentNullException(nameof(vertices));
            if (indices == null) throw new ArgumentNullException(nameof(indices));
            using (var pinned = new PinnedWorld(settings, doors))
            {
                NativeWorldSettings native = pinned.Settings;
                fixed (Vec3* points = vertices)
                fixed (int* corners = indices)
                {
                    ForewalkLibrary.Check(Native.forewalk_world_from_triangles(
                        (float*)points, ForewalkLibrary.Count(vertices), (uint*)corners,
                        ForewalkLibrary.Count(indices), &native, out WorldHandle handle));
                    return new ForewalkWorld(handle);
                }
            }
        }

        /// <summary>Obstacles that come, or move to where they are now; those of one call are seen at
        /// once. In the graph some 20 ms later.</summary>
        public void SetObstacles(params Obstacle[] obstacles)
        {
            if (obstacles == null) throw new ArgumentNullException(nameof(obstacles));
            using (var pins = new Pins())
            {
                var natives = new NativeObstacle[obstacles.Length];
                for (int i = 0; i < obstacles.Length; ++i)
                {
                    Obstacle obstacle = obstacles[i] ??
                        throw new ArgumentException($"Obstacle {i} is null.", nameof(obstacles));
                    natives[i] = new NativeObstacle {
                        Id = obstacle.Id,
                        Shape = obstacle.Shape,
                        Position = obstacle.Position,
                        HalfSize = obstacle.HalfSize,
                        Heading = obstacle.Heading,
                        Radius = obstacle.Radius,
                        Height = obstacle.Height,
                        Corners = (Vec3*)pins.Pin(obstacle.Corners),
                        CornerCount = ForewalkLibrary.Count(obstacle.Corners)
                    };
                }
                fixed (NativeObstacle* some = natives)
                {
                    ForewalkLibrary.Check(Native.forewalk_world_set_obstacles(
                        Handle, some, ForewalkLibrary.Count(natives)));
                }
            }
        }

        /// <summary>One that is not there may go, too.</summary>
        public void RemoveObstacle(uint id) =>
            ForewalkLibrary.Check(Native.forewalk_world_remove_obstacle(Handle, id));

        /// <summary>A door as it is now, in the place of the one with its id. Seen by frames that begin
        /// after the call.</summary>
        public void SetDoor(Door door)
        {
            using (var pins = new Pins())
            {
                NativeDoor native = pins.Pin(door);
                ForewalkLibrary.Check(Native.forewalk_world_set_door(Handle, &native));
            }
        }

        /// <summary>A link, in the place of the one with its id.</summary>
        public void SetLink(Link link) =>
            ForewalkLibrary.Check(Native.forewalk_world_set_link(Handle, &link));

        /// <summary>One that is not there may go, too.</summary>
        public void RemoveLink(uint id) =>
            ForewalkLibrary.Check(Native.forewalk_world_remove_link(Handle, id));

        /// <summary>Who stands where, all of them, in the place of those before.</summary>
        public void SetStanding(params Standing[] standing)
        {
            fixed (Standing* some = standing)
            {
                ForewalkLibrary.Check(Native.forewalk_world_set_standing(
                    Handle, some, ForewalkLibrary.Count(standing)));
            }
        }

        /// <summary>Waits until all changes so far are to be seen.</summary>
        /// <exception cref="ForewalkException">Why the last one that could not be carried out could not
        /// be: then the floor is as before it.</exception>
        public void Wait() => ForewalkLibrary.Check(Native.forewalk_world_wait(Handle));

        /// <summary>Ascending from 1 with every change that is to be seen.</summary>
        public ulong Version => Native.forewalk_world_version(Handle);

        public void Dispose() => Handle.Dispose();

        /// <summary>Keeps arrays where they are until it is disposed of.</summary>
        private sealed class Pins : IDisposable
        {
            private readonly List<GCHandle> handles = new List<GCHandle>();

            public void* Pin(Array array)
            {
                if (array == null || array.Length == 0) return null;
                GCHandle handle = GCHandle.Alloc(array, GCHandleType.Pinned);
                handles.Add(handle);
                return (void*)handle.AddrOfPinnedObject();
            }

            public NativeDoor Pin(Door door)
            {
                if (door == null) throw new ArgumentNullException(nameof(door));
                return new NativeDoor {
                    Id = door.Id,
                    Open = door.IsOpen ? 1 : 0,
                    Corners = (Vec3*)Pin(door.Corners),
                    CornerCount = ForewalkLibrary.Count(door.Corners),
                    Height = door.Height,
                    Cost = door.Cost
                };
            }

            public void Dispose()
            {
                foreach (GCHandle handle in handles) handle.Free();
                handles.Clear();
            }
        }

        /// <summary>Settings of a world, and what they point to.</summary>
        private sealed class PinnedWorld : IDisposable
        {
            public readonly NativeWorldSettings Settings;
            private readonly Pins pins = new Pins();

            public PinnedWorld(BuildSettings settings, Door[] doors)
            {
                ForewalkLibrary.Load();
                NativeWorldSettings defaults;
                Native.forewalk_world_settings_init(&defaults, (uint)sizeof(NativeWorldSettings));
                Settings = defaults;
                Settings.Axes = Axes.Unity;
                if (settings != null)
                {
                    var build = new[] { settings.ToNative() };
                    Settings.Build = (NativeBuildSettings*)pins.Pin(build);
                }
                if (doors == null || doors.Length == 0) return;
                var natives = new NativeDoor[doors.Length];
                for (int i = 0; i < doors.Length; ++i) natives[i] = pins.Pin(doors[i]);
                Settings.Doors = (NativeDoor*)pins.Pin(natives);
                Settings.DoorCount = ForewalkLibrary.Count(natives);
            }

            public void Dispose() => pins.Dispose();
        }
    }
}
