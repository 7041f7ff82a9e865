namespace Forewalk
{
    /// <summary>How to read a scene and whom to build for. A new one holds the library's defaults: a
    /// walking person in a scene in metres.</summary>
    public sealed unsafe class BuildSettings
    {
        /// <summary>Of scene files: +Z is up, not +Y. Not used with triangles in memory.</summary>
        public bool ZUp;
        /// <summary>Of the scene, more than 0; 0.01 for centimetres.</summary>
        public float MetresPerUnit;
        /// <summary>Of the walker, metres, 0 or more.</summary>
        public float Radius;
        /// <summary>Of the walker, metres, more than 0.</summary>
        public float Height;
        /// <summary>Highest step, metres, 0 or more.</summary>
        public float Climb;
        /// <summary>Steepest ground, radians, from 0 to below pi/2.</summary>
        public float Slope;
        /// <summary>Voxel size on the ground, metres, more than 0; at half of it a build takes 4 times
        /// as long.</summary>
        public float Cell;
        /// <summary>Voxel height, metres, more than 0.</summary>
        public float CellHeight;
        /// <summary>Side of a tile, metres; 0: one piece, built by one thread.</summary>
        public float Tile;
        public Partition Partition;

        public BuildSettings()
        {
            ForewalkLibrary.Load();
            NativeBuildSettings defaults;
            Native.forewalk_build_settings_init(&defaults, (uint)sizeof(NativeBuildSettings));
            ZUp = defaults.ZUp != 0;
            MetresPerUnit = defaults.MetresPerUnit;
            Radius = defaults.Radius;
            Height = defaults.Height;
            Climb = defaults.Climb;
            Slope = defaults.Slope;
            Cell = defaults.Cell;
            CellHeight = defaults.CellHeight;
            Tile = defaults.Tile;
            Partition = defaults.Partition;
        }

        internal NativeBuildSettings ToNative() => new NativeBuildSettings {
            StructSize = (uint)sizeof(NativeBuildSettings),
            ZUp = ZUp ? 1 : 0,
            MetresPerUnit = MetresPerUnit,
            Radius = Radius,
            Height = Height,
            Climb = Climb,
            Slope = Slope,
            Cell = Cell,
            CellHeight = CellHeight,
            Tile = Tile,
            Partition = Partition
        };
    }
}
