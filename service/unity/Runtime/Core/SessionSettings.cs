using System;

namespace Forewalk
{
    /// <summary>One user: where they are tracked, and how they are steered. A new one holds the
    /// library's defaults. Read while a session is made; changing it later changes nothing.</summary>
    public sealed unsafe class SessionSettings
    {
        public Controller Controller;
        public GainLimits Limits;
        /// <summary>Metres ahead along the virtual path, above 0 and up to 1000.</summary>
        public float Horizon;

        /// <summary>A simple polygon, either way round, in the tracking system's coordinates, 4096
        /// points at most, holes included. Null: a rectangle of Width (x) by Depth (z) about the
        /// origin.</summary>
        public Point2[] Border;
        /// <summary>Metres, 0.1 to 10000; 0: 4 metres.</summary>
        public float Width, Depth;
        /// <summary>Pillars and tables inside the border, which must then be given in points. Null:
        /// none.</summary>
        public Point2[][] Holes;
        /// <summary>A room that others are in as well, in the place of border, width, depth and holes.
        /// Null: a room of one's own.</summary>
        public ForewalkSpace Space;

        /// <summary>The point of the virtual floor above which the first frame's head is put. Null:
        /// virtual space is physical space at first.</summary>
        public Vec3? StartFloor;
        /// <summary>Where that head looks: radians, 0 is +Z, positive to the right.</summary>
        public float StartHeading;

        /// <summary>For <see cref="GainLimits.Custom"/>; not read with the others. Ratios are virtual
        /// over physical, with 0 &lt; min &lt;= 1 &lt;= max; curvature is in 1/metre, 0 to 10.</summary>
        public float TranslationMin, TranslationMax, RotationMin, RotationMax, CurvatureMax, BendingMin,
            BendingMax;

        /// <summary>Most polygons in one prediction, 1 or more.</summary>
        public int PolygonLimit;
        /// <summary>False: never stop the user.</summary>
        public bool Resets;
        public ResetMethod Reset;
        /// <summary>False: only where the controller asks for it.</summary>
        public bool AlwaysPredict;
        public PredictionMethod Method;
        /// <summary>For <see cref="PredictionMethod.Front"/>: ways shorter than this are part of the one
        /// they leave; metres, 0 to 100.</summary>
        public float Persistence;
        /// <summary>Names and likelihoods of ways in every frame's graph; false: only where the
        /// controller asks for them.</summary>
        public bool Likelihoods;
        public HeadingSource HeadingSource;

        public SessionSettings()
        {
            ForewalkLibrary.Load();
            NativeSessionSettings defaults;
            Native.forewalk_session_settings_init(&defaults, (uint)sizeof(NativeSessionSettings));
            Controller = defaults.Controller;
            Limits = defaults.Limits;
            Horizon = defaults.Horizon;
            Width = defaults.Width;
            Depth = defaults.Depth;
            StartHeading = defaults.StartHeading;
            TranslationMin = defaults.TranslationMin;
            TranslationMax = defaults.TranslationMax;
            RotationMin = defaults.RotationMin;
            RotationMax = defaults.RotationMax;
            CurvatureMax = defaults.CurvatureMax;
            BendingMin = defaults.BendingMin;
            BendingMax = defaults.BendingMax;
            PolygonLimit = (int)defaults.PolygonLimit;
            Resets = defaults.Resets != 0;
            Reset = defaults.Reset;
            AlwaysPredict = defaults.AlwaysPredict != 0;
            Method = defaults.Method;
            Persistence = defaults.Persistence;
            Likelihoods = defaults.Likelihoods != 0;
            HeadingSource = defaults.HeadingSource;
        }

        internal SessionHandle MakeSession(ForewalkNavMesh navmesh, ForewalkWorld world)
        {
            var holes = new FlatHoles(Holes);
            bool isHeld = false;
            try
            {
                // The library gets the space's bare pointer: it must live until the call returns.
                Space?.Handle.DangerousAddRef(ref isHeld);
                fixed (Point2* border = Border)
                fixed (Point2* holePoints = holes.Points)
                fixed (UIntPtr* holeSizes = holes.Sizes)
                {
                    NativeSessionSettings native = ToNative();
                    native.Border = border;
                    native.BorderCount = ForewalkLibrary.Count(Border);
                    native.HolePoints = holePoints;
                    native.HoleSizes = holeSizes;
                    native.HoleCount = ForewalkLibrary.Count(holes.Sizes);
                    SessionHandle session;
                    ForewalkLibrary.Check(
                        world == null
                            ? Native.forewalk_session_create(navmesh.Handle, &native, out session)
                            : Native.forewalk_session_create_in_world(world.Handle, &native,
                                                                      out session));
                    return session;
                }
            }
            finally
            {
                if (isHeld) Space.Handle.DangerousRelease();
            }
        }

        private NativeSessionSettings ToNative() => new NativeSessionSettings {
            StructSize = (uint)sizeof(NativeSessionSettings),
            Axes = Axes.Unity,
            Controller = Controller,
            Limits = Limits,
            Horizon = Horizon,
            Width = Width,
            Depth = Depth,
            HasStart = StartFloor.HasValue ? 1 : 0,
            StartFloor = StartFloor.GetValueOrDefault(),
            StartHeading = StartHeading,
            TranslationMin = TranslationMin,
            TranslationMax = TranslationMax,
            RotationMin = RotationMin,
            RotationMax = RotationMax,
            CurvatureMax = CurvatureMax,
            BendingMin = BendingMin,
            BendingMax = BendingMax,
            PolygonLimit = (uint)PolygonLimit,
            Resets = Resets ? 1 : 0,
            AlwaysPredict = AlwaysPredict ? 1 : 0,
            Method = Method,
            Persistence = Persistence,
            Reset = Reset,
            Likelihoods = Likelihoods ? 1 : 0,
            HeadingSource = HeadingSource,
            Space = Space == null ? IntPtr.Zero : Space.Handle.DangerousGetHandle()
        };
    }
}
