using System;

namespace Forewalk
{
    /// <summary>One user's walk. Each frame it is told the tracked head and answers with the virtual
    /// one. Any thread, but one at a time: calls on one session must not overlap. Everything is in
    /// Unity's axes, metres, seconds and radians, angles positive to the right.</summary>
    /// <remarks>With a predictive controller making one takes 0.05 to 0.15 s: do it while a level
    /// loads. A frame costs some 5 microseconds for a horizon of 10 m in an office and leaves no
    /// garbage; nor does reading <see cref="Graph"/>.</remarks>
    public sealed unsafe class ForewalkSession : IDisposable
    {
        private readonly SessionHandle handle;
        private readonly ForewalkGraph graph = new ForewalkGraph();
        private FrameOut latest;
        private bool isGraphLatest;

        /// <exception cref="ForewalkException">Settings that cannot work; a start more than 0.5 m off
        /// the floor; a space that has no place left.</exception>
        public ForewalkSession(ForewalkNavMesh navmesh, SessionSettings settings = null)
            : this((settings ?? new SessionSettings()).MakeSession(
                  navmesh ?? throw new ArgumentNullException(nameof(navmesh)), null))
        {
        }

        /// <summary>In a world that moves: frames take its newest version.</summary>
        public ForewalkSession(ForewalkWorld world, SessionSettings settings = null)
            : this((settings ?? new SessionSettings()).MakeSession(
                  null, world ?? throw new ArgumentNullException(nameof(world))))
        {
        }

        private ForewalkSession(SessionHandle session)
        {
            handle = session;
            latest.StructSize = (uint)sizeof(FrameOut);
        }

        /// <summary>One frame: the tracked head in the tracking system's space, its floor at height 0,
        /// and the time of that pose on any clock that does not run backwards, in seconds. Call it once
        /// for each rendered frame, at any rate above 2 Hz.</summary>
        /// <returns>Odd input is reported in its flags; whatever comes in, what comes out is
        /// finite.</returns>
        public FrameOut Frame(in ForewalkPose head, double seconds)
        {
            graph.Clear();
            isGraphLatest = false;
            ForewalkLibrary.Check(Native.forewalk_frame(handle, head.Position, head.Orientation,
                                                        seconds, ref latest));
            return latest;
        }

        /// <summary>What the latest frame answered.</summary>
        public FrameOut Latest => latest;

        /// <summary>What the latest frame predicted. One object for the session's life, which the next
        /// frame empties and the next look at this property fills again.</summary>
        public ForewalkGraph Graph
        {
            get
            {
                if (!isGraphLatest)
                {
                    graph.Fill(handle);
                    isGraphLatest = true;
                }
                return graph;
            }
        }

        /// <summary>Puts the user's next frame at another place of the virtual floor (a teleport, a
        /// lift), looking along `heading`: radians, 0 is +Z. Nobody moves in the tracked room.</summary>
        /// <exception cref="ForewalkException">More than 0.5 m off the floor; nothing
        /// changes.</exception>
        public void Teleport(Vec3 floor, float heading) =>
            ForewalkLibrary.Check(Native.forewalk_session_teleport(handle, floor, heading));

        /// <summary>Where the eyes look from the next frame on, a direction of the tracked space of any
        /// length: evidence for the likelihoods. Null: not known, as at first.</summary>
        public void SetGaze(Vec3? direction)
        {
            Vec3 known = direction.GetValueOrDefault();
            ForewalkLibrary.Check(
                Native.forewalk_session_set_gaze(handle, direction.HasValue ? &known : null));
        }

        /// <summary>The same for where the chest points, which <see cref="HeadingSource.Chest"/> steers
        /// by.</summary>
        public void SetChest(Vec3? direction)
        {
            Vec3 known = direction.GetValueOrDefault();
            ForewalkLibrary.Check(
                Native.forewalk_session_set_chest(handle, direction.HasValue ? &known : null));
        }

        /// <summary>Records the frames in a file from now on, in the place of one of that name, which
        /// `forewalk replay` walks again to the last bit. Null: no more. The controller's gains go back
        /// to neutral once. Not for within a frame's time budget.</summary>
        /// <exception cref="ForewalkException">The file cannot be written.</exception>
        public void Record(string path)
        {
            fixed (byte* text = path == null ? null : ForewalkLibrary.BytesOf(path))
            {
                ForewalkLibrary.Check(Native.forewalk_session_record(handle, text));
            }
        }

        /// <summary>Puts these links in the place of those before. For sessions on a navmesh; those in a
        /// world are told through it. Between frames.</summary>
        public void SetLinks(params Link[] links)
        {
            fixed (Link* some = links)
            {
                ForewalkLibrary.Check(Native.forewalk_session_set_links(
                    handle, some, ForewalkLibrary.Count(links)));
            }
        }

        /// <summary>Says who stands where, all of them, in the place of those before. As
        /// <see cref="SetLinks"/>.</summary>
        public void SetStanding(params Standing[] standing)
        {
            fixed (Standing* some = standing)
            {
                ForewalkLibrary.Check(Native.forewalk_session_set_standing(
                    handle, some, ForewalkLibrary.Count(standing)));
            }
        }

        /// <summary>Goes on in another navmesh of the same building, where the user stays at the same
        /// place of virtual space.</summary>
        public void Enter(ForewalkNavMesh navmesh)
        {
            if (navmesh == null) throw new ArgumentNullException(nameof(navmesh));
            ForewalkLibrary.Check(Native.forewalk_session_enter(handle, navmesh.Handle));
        }

        public void Dispose()
        {
            graph.Clear();
            handle.Dispose();
        }
    }
}
