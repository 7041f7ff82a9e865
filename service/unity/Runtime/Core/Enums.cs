// The constants of forewalk.h, under the names of C#. What each means is said there and, in short, here.
using System;

namespace Forewalk
{
    /// <summary>Why a call failed (<see cref="ForewalkException.Status"/>).</summary>
    public enum Status
    {
        Ok = 0,
        ErrorFileUnreadable = 1,
        ErrorFormatUnknown = 2,
        ErrorFormatUnsupported = 3,
        ErrorDataDamaged = 4,
        ErrorSceneEmpty = 5,
        ErrorSettingOutOfRange = 6,
        ErrorNothingWalkable = 7,
        ErrorTooLarge = 8,
        ErrorPositionOffNavMesh = 9,
        ErrorFileUnwritable = 10,
        ErrorArgument = 100,
        ErrorOutOfMemory = 101,
        ErrorInternal = 102
    }

    /// <summary>How much is told (<see cref="ForewalkLog"/>).</summary>
    public enum LogLevel
    {
        Off = 0,
        /// <summary>A call failed.</summary>
        Error = 1,
        /// <summary>A frame met what it had to make up for: lost poses, no floor, limits.</summary>
        Warning = 2,
        /// <summary>NavMeshes and sessions made, resets begun and ended.</summary>
        Info = 3
    }

    /// <summary>Whose axes and units somebody speaks. What this package makes speaks Unity's.</summary>
    public enum Axes
    {
        /// <summary>Right-handed, +Y up, forward -Z, metres; also glTF, Godot, WebXR.</summary>
        OpenXR = 0,
        /// <summary>Left-handed, +Y up, forward +Z, metres. Angles are positive to the right.</summary>
        Unity = 1,
        /// <summary>Left-handed, +Z up, forward +X, centimetres.</summary>
        Unreal = 2
    }

    /// <summary>How Recast cuts the floor into polygons.</summary>
    public enum Partition
    {
        Watershed = 0,
        Monotone = 1,
        Layers = 2
    }

    /// <summary>What picks the gains.</summary>
    public enum Controller
    {
        /// <summary>No gains; resets all the same.</summary>
        None = 0,
        /// <summary>Steer-to-center as published.</summary>
        S2C = 1,
        /// <summary>Steer-to-orbit as published.</summary>
        S2O = 2,
        /// <summary>Steer-to-center fed by the prediction graph; the default.</summary>
        S2CPredictive = 3,
        /// <summary>Steer-to-orbit fed by the prediction graph.</summary>
        S2OPredictive = 4,
        S2MT = 5,
        S2MTCentre = 6,
        Zigzag = 7,
        P2R = 8,
        Messinger = 9,
        DynamicApf = 10,
        Haptics = 11,
        Arc = 12,
        Visibility = 13,
        /// <summary>Plans on the prediction graph, as the next two; the fewest resets.</summary>
        Foresight = 14,
        MpcRed = 15,
        Force = 16
    }

    /// <summary>How a reset turns the user.</summary>
    public enum ResetMethod
    {
        /// <summary>180 degrees either way, 360 seen; the default.</summary>
        TwoOneTurn = 0,
        /// <summary>180 degrees either way, nothing seen.</summary>
        FreezeTurn = 1,
        /// <summary>Steps back, nothing seen.</summary>
        FreezeBackup = 2,
        /// <summary>To the centre; this and the rest: 360 degrees seen.</summary>
        R2C = 3,
        MR2C = 4,
        R2G = 5,
        SFR2G = 6,
        R2FD = 7,
        /// <summary>To where the likely ways ahead fit the room best.</summary>
        Ahead = 8
    }

    /// <summary>How far gains may go.</summary>
    public enum GainLimits
    {
        /// <summary>Detection thresholds of Steinicke et al. 2010; the default.</summary>
        Steinicke = 0,
        /// <summary>The same with curvature up to 1/7.5 per metre.</summary>
        Laboratory = 1,
        /// <summary>The same with curvature up to 1/10 per metre.</summary>
        Neth = 2,
        /// <summary>What RDWT and OpenRDW ship.</summary>
        Toolkit = 3,
        /// <summary>The numbers in the settings.</summary>
        Custom = 4
    }

    /// <summary>How the prediction graph is made.</summary>
    public enum PredictionMethod
    {
        /// <summary>As published: polygons of the navmesh are the branches; the default.</summary>
        Polygon = 0,
        /// <summary>Real junctions, whatever the polygons.</summary>
        Front = 1
    }

    /// <summary>What a heading is taken from by controllers that follow one.</summary>
    public enum HeadingSource
    {
        Head = 0,
        /// <summary><see cref="ForewalkSession.SetChest"/>; the head where nothing was told.</summary>
        Chest = 1,
        /// <summary>The direction of travel while walking, else the head.</summary>
        Walking = 2
    }

    /// <summary>What to tell the user in a reset.</summary>
    public enum ResetInstruction
    {
        None = 0,
        /// <summary>Stop, and turn on the spot, either way.</summary>
        TurnAround = 1,
        /// <summary>Go on turning the same way.</summary>
        KeepTurning = 2,
        /// <summary>Walk back into the tracked space.</summary>
        WalkBack = 3,
        /// <summary>Stop, and step backwards.</summary>
        StepBack = 4,
        /// <summary>Stop, and turn left on the spot.</summary>
        TurnLeft = 5,
        /// <summary>Stop, and turn right on the spot.</summary>
        TurnRight = 6
    }

    /// <summary>What a reset is at.</summary>
    public enum ResetPhase
    {
        None = 0,
        /// <summary>The border is near: a reset is about to be needed.</summary>
        Near = 1,
        /// <summary>Outside the tracked space: to walk back in.</summary>
        Outside = 2,
        /// <summary>Stopped: <see cref="FrameOut.ResetBack"/> to step backwards.</summary>
        Backward = 3,
        /// <summary>Stopped: to turn by <see cref="FrameOut.ResetRemaining"/>, not begun yet.</summary>
        Turn = 4,
        /// <summary>The turn is under way.</summary>
        Turning = 5
    }

    /// <summary>What a frame met. The first five also mean that no gain was applied.</summary>
    [Flags]
    public enum FrameFlags : uint
    {
        None = 0,
        /// <summary>Nothing to compare with yet.</summary>
        FirstFrame = 1 << 0,
        /// <summary>The same time again; the step counts in the next.</summary>
        TimeStoodStill = 1 << 1,
        /// <summary>Or was not a number; time goes on from here.</summary>
        TimeRanBackwards = 1 << 2,
        /// <summary>More than 0.5 s since the last frame.</summary>
        TimeGap = 1 << 3,
        /// <summary>Moved more than 1 m, and the virtual head as far.</summary>
        TrackingJump = 1 << 4,
        /// <summary>The last sound position was taken.</summary>
        PoseNotFinite = 1 << 5,
        /// <summary>It was normalised.</summary>
        OrientationNotUnit = 1 << 6,
        /// <summary>The last sound one was taken.</summary>
        OrientationUnusable = 1 << 7,
        /// <summary>The head is outside the tracked space.</summary>
        OutsideSpace = 1 << 8,
        /// <summary>A reset is about to be needed.</summary>
        BorderNear = 1 << 9,
        /// <summary>No walkable floor near: the last place was taken.</summary>
        OffNavMesh = 1 << 10,
        /// <summary>Beside the navmesh: its nearest point was taken.</summary>
        Snapped = 1 << 11,
        /// <summary>Raise PolygonLimit or shorten the horizon.</summary>
        GraphLimit = 1 << 12,
        /// <summary>The world changed where the user stands, who was put on the nearest floor.</summary>
        GroundTaken = 1 << 13
    }

    public enum NodeKind : byte
    {
        Source = 0,
        /// <summary>The ways part.</summary>
        Branch = 1,
        /// <summary>Prediction stops.</summary>
        Terminal = 2,
        /// <summary>Ways come together (<see cref="PredictionMethod.Front"/> only).</summary>
        Join = 3
    }

    /// <summary>Why prediction stops at a terminal.</summary>
    public enum TerminalReason : byte
    {
        None = 0,
        Horizon = 1,
        DeadEnd = 2,
        /// <summary>Another way comes toward this one (<see cref="PredictionMethod.Front"/> only).</summary>
        Meeting = 3
    }

    public enum WayChange : byte
    {
        /// <summary>The way is new and comes from nowhere known.</summary>
        Birth = 0,
        /// <summary>The way is gone and none took its place.</summary>
        Death = 1,
        /// <summary>The way is new; up to now it was one with Other.</summary>
        Split = 2,
        /// <summary>The way is gone; from now on it is one with Other.</summary>
        Merge = 3,
        /// <summary>The way is back that had vanished a moment ago.</summary>
        Return = 4
    }

    public enum ObstacleShape
    {
        /// <summary>Upright, turned about its vertical axis.</summary>
        Box = 0,
        /// <summary>Upright.</summary>
        Cylinder = 1,
        /// <summary>A convex outline drawn up, 3 to 64 corners.</summary>
        Prism = 2
    }
}
