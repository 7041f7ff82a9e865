// The prediction graph, read where it lies in the library's memory: no copies, no garbage.
//
// The lists below are views of the graph object and look at its pointers at each access, so that a
// list which outlives its frame is empty and throws, and never reads what is no longer there.
using System;

namespace Forewalk
{
    /// <summary>The user's possible ways ahead, as of one frame (<see cref="ForewalkSession.Graph"/>).
    /// Empty before the first frame, where nothing was predicted, and from the next frame on until it is
    /// asked for again. Not for another thread than the session's.</summary>
    public sealed unsafe class ForewalkGraph
    {
        internal NativeGraphView View;

        internal ForewalkGraph() {}

        internal void Fill(SessionHandle session)
        {
            View.StructSize = (uint)sizeof(NativeGraphView);
            ForewalkLibrary.Check(Native.forewalk_graph(session, ref View));
        }

        internal void Clear() => View = default;

        /// <summary>The first is the source.</summary>
        public NodeList Nodes => new NodeList(this);
        public EdgeList Edges => new EdgeList(this);
        /// <summary>Of all edges' paths.</summary>
        public PointList Points => new PointList(this, 0, -1);
        /// <summary>Of one edge: on the floor, from its From to its To.</summary>
        public PointList Path(in Edge edge) =>
            new PointList(this, (int)edge.PathStart, (int)edge.PathCount);
        /// <summary>One a terminal, in the order of nodes; none with
        /// <see cref="PredictionMethod.Polygon"/>.</summary>
        public FrontList Fronts => new FrontList(this);
        /// <summary>One a terminal, in the order of nodes; none where nobody wants likelihoods.</summary>
        public WayList Ways => new WayList(this);
        /// <summary>Of this frame alone: look in every frame to miss none.</summary>
        public WayEventList WayEvents => new WayEventList(this);

        /// <summary>Of an edge's way, its narrower end, metres; 0 with
        /// <see cref="PredictionMethod.Polygon"/>.</summary>
        public float Width(int edge) =>
            View.Widths[Checked(edge, View.Widths == null ? 0 : View.EdgeCount)];

        /// <summary>Metres.</summary>
        public float Horizon => View.Horizon;
        /// <summary>All ways are known out to here; less than the horizon at a limit.</summary>
        public float CompleteTo => View.CompleteTo;
        public PredictionMethod Method => View.Method;
        /// <summary>That the user takes none of the ways.</summary>
        public float LikelihoodNone => View.LikelihoodNone;

        internal static int Checked(int index, uint count)
        {
            if ((uint)index >= count) ThrowOutside(index, count);
            return index;
        }

        private static void ThrowOutside(int index, uint count) =>
            throw new ArgumentOutOfRangeException(
                nameof(index), index,
                $"The list has {count} entries. Lists of a graph end with their frame: ask the session " +
                    "for its graph again.");
    }

    public readonly unsafe struct NodeList
    {
        private readonly ForewalkGraph graph;
        internal NodeList(ForewalkGraph graph) { this.graph = graph; }
        public int Count => (int)graph.View.NodeCount;
        public Node this[int index] =>
            graph.View.Nodes[ForewalkGraph.Checked(index, graph.View.NodeCount)];
    }

    public readonly unsafe struct EdgeList
    {
        private readonly ForewalkGraph graph;
        internal EdgeList(ForewalkGraph graph) { this.graph = graph; }
        public int Count => (int)graph.View.EdgeCount;
        public Edge this[int index] =>
            graph.View.Edges[ForewalkGraph.Checked(index, graph.View.EdgeCount)];
    }

    public readonly unsafe struct PointList
    {
        private readonly ForewalkGraph graph;
        private readonly int start;
        private readonly int count;  // -1: all

        internal PointList(ForewalkGraph graph, int start, int count)
        {
            this.graph = graph;
            this.start = start;
            this.count = count;
        }

        public int Count
        {
            get
            {
                int all = (int)graph.View.PointCount;
                if (count < 0) return all;
                // Of an edge that this graph no longer has: none.
                return start <= all - count ? count : 0;
            }
        }

        public Vec3 this[int index] =>
            graph.View.Points[start + ForewalkGraph.Checked(index, (uint)Count)];
    }

    public readonly unsafe struct FrontList
    {
        private readonly ForewalkGraph graph;
        internal FrontList(ForewalkGraph graph) { this.graph = graph; }
        public int Count => (int)graph.View.FrontCount;
        public Front this[int index] =>
            graph.View.Fronts[ForewalkGraph.Checked(index, graph.View.FrontCount)];
    }

    public readonly unsafe struct WayList
    {
        private readonly ForewalkGraph graph;
        internal WayList(ForewalkGraph graph) { this.graph = graph; }
        public int Count => (int)graph.View.WayCount;
        public Way this[int index] =>
            graph.View.Ways[ForewalkGraph.Checked(index, graph.View.WayCount)];
    }

    public readonly unsafe struct WayEventList
    {
        private readonly ForewalkGraph graph;
        internal WayEventList(ForewalkGraph graph) { this.graph = graph; }
        public int Count => (int)graph.View.WayEventCount;
        public WayEvent this[int index] =>
            graph.View.WayEvents[ForewalkGraph.Checked(index, graph.View.WayEventCount)];
    }
}
