// The library as a whole: its version, its errors as exceptions, its log.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Forewalk
{
    /// <summary>A call was refused. The message is the library's sentence: where, what, with the number
    /// and its unit, and what to try.</summary>
    public sealed class ForewalkException : Exception
    {
        public ForewalkException(Status status, string message) : base(message)
        {
            Status = status;
        }

        public Status Status { get; }
    }

    public static unsafe class ForewalkLibrary
    {
        /// <summary>Of the header that this package mirrors.</summary>
        public const int VersionMajor = 0, VersionMinor = 1, VersionPatch = 0;

        /// <summary>Of the library that is loaded.</summary>
        /// <exception cref="DllNotFoundException">There is none to load.</exception>
        public static Version Version
        {
            get
            {
                uint version = Native.forewalk_version();
                return new Version((int)(version >> 16), (int)(version >> 8 & 0xff),
                                   (int)(version & 0xff));
            }
        }

        private static bool isSuitable;

        /// <summary>Loads the library and refuses one that this package cannot speak to. Called before
        /// anything is made.</summary>
        internal static void Load()
        {
            if (isSuitable) return;
            Version loaded = Version;
            if (loaded.Major != VersionMajor || loaded.Minor < VersionMinor)
            {
                throw new ForewalkException(Status.ErrorFormatUnsupported,
                    $"The forewalk library that is loaded has version {loaded}, this package speaks " +
                    $"{VersionMajor}.{VersionMinor}. Install both from one release.");
            }
            isSuitable = true;
        }

        internal static void Check(Status status)
        {
            if (status != Status.Ok)
            {
                throw new ForewalkException(status, TextAt(Native.forewalk_last_error()));
            }
        }

        /// <summary>UTF-8, ended by a zero.</summary>
        internal static string TextAt(IntPtr text)
        {
            byte* bytes = (byte*)text;
            if (bytes == null) return "";
            int count = 0;
            while (bytes[count] != 0) ++count;
            return count == 0 ? "" : Encoding.UTF8.GetString(bytes, count);
        }

        internal static byte[] BytesOf(string text)
        {
            if (text == null) throw new ArgumentNullException(nameof(text));
            var bytes = new byte[Encoding.UTF8.GetByteCount(text) + 1];
            Encoding.UTF8.GetBytes(text, 0, text.Length, bytes, 0);
            return bytes;
        }

        internal static UIntPtr Count(Array array) =>
            new UIntPtr(array == null ? 0u : (uint)array.Length);
    }

    /// <summary>What the library tells, one sentence at a time. There are no poses in it.</summary>
    public static class ForewalkLog
    {
        // The library keeps a bare pointer: these must outlive its use of it.
        private static readonly NativeLogFunction tell = Tell;
        private static Action<LogLevel, string> listener;
        private static bool isWatchingUnload;

        /// <summary>For the whole process, in the place of the one before. The listener is called on the
        /// thread that made a call, from within it, and must not call forewalk; what it throws is lost.
        /// Null or <see cref="LogLevel.Off"/>: nobody is told. Call it while no other thread is in a
        /// call. What is told allocates a string; frames tell only what is new.</summary>
        public static void Listen(Action<LogLevel, string> newListener, LogLevel most)
        {
            ForewalkLibrary.Load();
            bool isOn = newListener != null && most != LogLevel.Off;
            Native.forewalk_set_log(null, IntPtr.Zero, LogLevel.Off);
            listener = isOn ? newListener : null;
            if (!isOn) return;
            if (!isWatchingUnload)
            {
                // Unity's editor unloads the scripts at each start of play mode, and keeps the library.
                AppDomain.CurrentDomain.DomainUnload += (sender, arguments) =>
                    Native.forewalk_set_log(null, IntPtr.Zero, LogLevel.Off);
                isWatchingUnload = true;
            }
            Native.forewalk_set_log(tell, IntPtr.Zero, most);
        }

        [MonoPInvokeCallback(typeof(NativeLogFunction))]
        private static void Tell(IntPtr user, LogLevel level, IntPtr message)
        {
            try
            {
                listener?.Invoke(level, ForewalkLibrary.TextAt(message));
            }
            catch (Exception)
            {
                // No exception may cross the library's frames.
            }
        }

        // IL2CPP knows it by its name: a method that native code may call.
        [AttributeUsage(AttributeTargets.Method)]
        private sealed class MonoPInvokeCallbackAttribute : Attribute
        {
            public MonoPInvokeCallbackAttribute(Type type) {}
        }
    }
}
