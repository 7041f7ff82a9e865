using System;
using UnityEngine;
using UnityEngine.Events;

namespace Forewalk.Unity
{
    /// <summary>What a reset asks of the user now, for whoever draws it.</summary>
    public readonly struct ResetPrompt
    {
        public ResetPrompt(in FrameOut frame, Quaternion rig)
        {
            Instruction = frame.Instruction;
            Phase = frame.ResetPhase;
            DegreesLeft = frame.ResetRemaining * Mathf.Rad2Deg;
            StepBack = frame.ResetBack;
            Direction = rig * frame.ResetDirection.ToUnity();
        }

        /// <summary><see cref="ResetInstruction.None"/>: nothing; take the prompt away.</summary>
        public ResetInstruction Instruction { get; }
        public ResetPhase Phase { get; }
        /// <summary>Of the body, to turn; 0 or more.</summary>
        public float DegreesLeft { get; }
        /// <summary>Metres to step back before the turn; 0 or more.</summary>
        public float StepBack { get; }
        /// <summary>Where the user will face when the turn is done, in the scene as it stands in this
        /// frame: horizontal, of length 1, zero while there is no turn. It moves with the room, so draw
        /// an arrow anew in each frame, or below the rig.</summary>
        public Vector3 Direction { get; }

        /// <summary>A sentence to show; "" where there is nothing to do.</summary>
        public string Text
        {
            get
            {
                switch (Instruction)
                {
                    case ResetInstruction.TurnAround: return "Stop, and turn around on the spot";
                    case ResetInstruction.KeepTurning: return "Keep turning the same way";
                    case ResetInstruction.WalkBack: return "Walk back into the room";
                    case ResetInstruction.StepBack: return "Stop, and step backwards";
                    case ResetInstruction.TurnLeft: return "Stop, and turn left on the spot";
                    case ResetInstruction.TurnRight: return "Stop, and turn right on the spot";
                    default: return "";
                }
            }
        }
    }

    /// <summary>Invoked with the new prompt.</summary>
    [Serializable]
    public sealed class ResetPromptEvent : UnityEvent<ResetPrompt> {}
}
