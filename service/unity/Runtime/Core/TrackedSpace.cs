// The tracked space as an application says it, laid out as the library reads it.
using System;

namespace Forewalk
{
    /// <summary>Pillars and tables of a tracked space, one after the other.</summary>
    internal struct FlatHoles
    {
        public Point2[] Points;  // null: none
        public UIntPtr[] Sizes;

        public FlatHoles(Point2[][] holes)
        {
            Points = null;
            Sizes = null;
            if (holes == null || holes.Length == 0) return;
            int count = 0;
            foreach (Point2[] hole in holes)
            {
                if (hole == null) throw new ArgumentException("A hole of the room is null.", "Holes");
                count += hole.Length;
            }
            Points = new Point2[count];
            Sizes = new UIntPtr[holes.Length];
            int next = 0;
            for (int i = 0; i < holes.Length; ++i)
            {
                Sizes[i] = new UIntPtr((uint)holes[i].Length);
                holes[i].CopyTo(Points, next);
                next += holes[i].Length;
            }
        }
    }

    /// <summary>A room that several people share. A new one holds the library's defaults.</summary>
    public sealed unsafe class SpaceSettings
    {
        /// <summary>A simple polygon, either way round, in the tracking system's coordinates. Null: a
        /// rectangle of Width (x) by Depth (z) about the origin.</summary>
        public Point2[] Border;
        /// <summary>Metres, 0.1 to 10000; 0: 4 metres.</summary>
        public float Width, Depth;
        /// <summary>Pillars and tables inside the border, which must then be given in points. Null:
        /// none.</summary>
        public Point2[][] Holes;
        /// <summary>How near the middles of two bodies may come, metres, above 0 and up to 5.</summary>
        public float BodyRadius;
        /// <summary>Most sessions at one time, 1 to 64.</summary>
        public int UserLimit;

        public SpaceSettings()
        {
            ForewalkLibrary.Load();
            NativeSpaceSettings defaults;
            Native.forewalk_space_settings_init(&defaults, (uint)sizeof(NativeSpaceSettings));
            Width = defaults.Width;
            Depth = defaults.Depth;
            BodyRadius = defaults.BodyRadius;
            UserLimit = (int)defaults.UserLimit;
        }
    }

    /// <summary>A tracked room that several sessions are in: each keeps clear of where the others are
    /// and go. Sessions keep what they need of it, so it may be disposed of while they live.</summary>
    public sealed unsafe class ForewalkSpace : IDisposable
    {
        internal readonly SpaceHandle Handle;

        public ForewalkSpace(SpaceSettings settings = null)
        {
            SpaceSettings known = settings ?? new SpaceSettings();
            var holes = new FlatHoles(known.Holes);
            fixed (Point2* border = known.Border)
            fixed (Point2* holePoints = holes.Points)
            fixed (UIntPtr* holeSizes = holes.Sizes)
            {
                var native = new NativeSpaceSettings {
                    StructSize = (uint)sizeof(NativeSpaceSettings),
                    Axes = Axes.Unity,
                    Border = border,
                    BorderCount = ForewalkLibrary.Count(known.Border),
                    Width = known.Width,
                    Depth = known.Depth,
                    HolePoints = holePoints,
                    HoleSizes = holeSizes,
                    HoleCount = ForewalkLibrary.Count(holes.Sizes),
                    BodyRadius = known.BodyRadius,
                    UserLimit = (uint)known.UserLimit
                };
                ForewalkLibrary.Check(Native.forewalk_space_create(&native, out Handle));
            }
        }

        public void Dispose() => Handle.Dispose();
    }
}
