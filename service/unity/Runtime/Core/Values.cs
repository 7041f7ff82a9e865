// Plain values that cross the border as they lie in memory: each mirrors the struct of forewalk.h
// that is named like it, field by field. A test compares sizes and offsets with C's.
//
// All places and directions are in Unity's axes, metres. Ids and indices that say UInt32.MaxValue
// mean none.
using System;
using System.Runtime.InteropServices;

#pragma warning disable 0649 // the library fills them

namespace Forewalk
{
    [StructLayout(LayoutKind.Sequential)]
    public struct Vec3
    {
        public float X, Y, Z;

        public Vec3(float x, float y, float z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        public override string ToString() => $"({X}, {Y}, {Z})";
    }

    /// <summary>A unit quaternion: turns the head's own axes into the world's.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Quat
    {
        public float X, Y, Z, W;

        public Quat(float x, float y, float z, float w)
        {
            X = x;
            Y = y;
            Z = z;
            W = w;
        }

        public override string ToString() => $"({X}, {Y}, {Z}, {W})";
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct ForewalkPose
    {
        public Vec3 Position;
        public Quat Orientation;

        public ForewalkPose(Vec3 position, Quat orientation)
        {
            Position = position;
            Orientation = orientation;
        }

        public override string ToString() => $"{Position} {Orientation}";
    }

    /// <summary>Horizontal point of the tracked room: Unity's x and z.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Point2
    {
        public float Right, Forward;

        public Point2(float right, float forward)
        {
            Right = right;
            Forward = forward;
        }
    }

    /// <summary>What a frame answers.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct FrameOut
    {
        internal uint StructSize;
        public FrameFlags Flags;
        /// <summary>Of the head: what to render from.</summary>
        public ForewalkPose VirtualPose;
        /// <summary>Gains as applied: virtual over physical, 1 does nothing.</summary>
        public float Translation;
        /// <summary>2 while resetting.</summary>
        public float Rotation;
        /// <summary>1/metre, positive to the right; 0 does nothing.</summary>
        public float Curvature;
        public float Bending;
        /// <summary>Radians by which the world was turned about the head this frame, positive to the
        /// right.</summary>
        public float InjectedYaw;
        /// <summary>By which the user was pushed this frame, virtual.</summary>
        public Vec3 InjectedTranslation;
        internal int Resetting;
        /// <summary>What to tell the user now.</summary>
        public ResetInstruction Instruction;
        /// <summary>Physical radians to go, 0 or more.</summary>
        public float ResetRemaining;
        /// <summary>Physical radians turned since it began; its sign is the way to go on.</summary>
        public float ResetTurned;
        /// <summary>Begun since the session was made.</summary>
        public uint ResetCount;
        /// <summary>Of this frame's prediction graph, 0 where there is none.</summary>
        public uint GraphNodes;
        /// <summary>Time spent finding the place and the graph.</summary>
        public float PredictSeconds;
        /// <summary>And choosing and applying gains.</summary>
        public float SteerSeconds;
        public ResetPhase ResetPhase;
        /// <summary>Metres to step back before the turn, 0 or more.</summary>
        public float ResetBack;
        /// <summary>Where the user will face when the turn is done: a horizontal unit vector of the
        /// tracked space, zero while there is no turn.</summary>
        public Vec3 ResetDirection;

        /// <summary>The user is being turned.</summary>
        public bool IsResetting => Resetting != 0;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Node
    {
        public Vec3 Position;
        /// <summary>Of the taut path from the source, metres.</summary>
        public float Distance;
        /// <summary>The branch node or source before it; none for the source.</summary>
        public uint Prev;
        /// <summary>None: the user is off the navmesh.</summary>
        public uint Polygon;
        public NodeKind Kind;
        public TerminalReason Reason;
        internal byte Branch;
        internal byte Reserved;

        /// <summary>A branch node; a terminal or a join can be one too.</summary>
        public bool IsBranch => Branch != 0;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Edge
    {
        /// <summary>Nodes.</summary>
        public uint From, To;
        /// <summary>Of the taut path between them, metres.</summary>
        public float Length;
        /// <summary>Its points in <see cref="ForewalkGraph.Points"/>, from From to To.</summary>
        public uint PathStart, PathCount;
        internal int Loop;

        /// <summary>Joins neighbours that the tree leaves apart; else it leads to its node's
        /// Prev.</summary>
        public bool IsLoop => Loop != 0;
    }

    /// <summary>The points at one distance from the source where people on a way would cross
    /// it.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Front
    {
        /// <summary>The terminal whose way it belongs to.</summary>
        public uint Node;
        /// <summary>Metres; 0 where the way ends before the horizon.</summary>
        public float Length;
        /// <summary>Its ends, on walls.</summary>
        public Vec3 From, To;
    }

    /// <summary>A way out of a polygon of a navmesh into its neighbour.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Portal
    {
        /// <summary>The polygon that it leads to.</summary>
        public uint To;
        /// <summary>That it lies on: from this corner of its polygon to the next.</summary>
        public uint Edge;
        /// <summary>Its ends, as somebody sees them who walks out.</summary>
        public Vec3 Left, Right;
    }

    /// <summary>A way from the user to a terminal, under a name that it keeps from frame to frame, and
    /// how likely it is that the user takes it.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Way
    {
        /// <summary>Never used twice by one session.</summary>
        public uint Id;
        /// <summary>The terminal it leads to.</summary>
        public uint Node;
        /// <summary>0 to 1; all ways' and <see cref="ForewalkGraph.LikelihoodNone"/> sum to
        /// 1.</summary>
        public float Likelihood;
        internal byte Born;
        internal byte Reserved0, Reserved1, Reserved2;

        /// <summary>New in this frame.</summary>
        public bool IsBorn => Born != 0;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct WayEvent
    {
        public uint Way;
        /// <summary>None unless a split or a merge.</summary>
        public uint Other;
        public WayChange Change;
        internal byte Reserved0, Reserved1, Reserved2;
    }

    /// <summary>A way that is not floor: a lift, a ladder, a teleport.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Link
    {
        /// <summary>One of its own.</summary>
        public uint Id;
        /// <summary>Within 0.5 m of the floor.</summary>
        public Vec3 Entry, Exit;
        /// <summary>Metres of walking that it counts for, 0 to 10000.</summary>
        public float Length;
        private int BothWays;
        private int Closed;

        public Link(uint id, Vec3 entry, Vec3 exit, float length, bool bothWays = false,
                    bool closed = false)
        {
            Id = id;
            Entry = entry;
            Exit = exit;
            Length = length;
            BothWays = bothWays ? 1 : 0;
            Closed = closed ? 1 : 0;
        }

        /// <summary>The exit is an entry as well.</summary>
        public bool IsBothWays => BothWays != 0;
        /// <summary>As if it were not there.</summary>
        public bool IsClosed => Closed != 0;
    }

    /// <summary>Somebody who stands somewhere. Polygons that nobody can cross past them are closed, or
    /// cost more.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Standing
    {
        public Vec3 Foot;
        /// <summary>Of the floor that others cannot use: theirs and the walker's, more than 0,
        /// metres.</summary>
        public float Radius;
        /// <summary>0: closed; else 1 to 1e6 metres for each metre through the polygon.</summary>
        public float Cost;

        public Standing(Vec3 foot, float radius, float cost = 0)
        {
            Foot = foot;
            Radius = radius;
            Cost = cost;
        }
    }
}
