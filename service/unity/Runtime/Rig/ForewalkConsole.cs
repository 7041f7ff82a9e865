using UnityEngine;

namespace Forewalk.Unity
{
    /// <summary>Shows what the library tells in Unity's console.</summary>
    public static class ForewalkConsole
    {
        /// <summary>For the whole process. Failed calls are not shown: they come as
        /// exceptions.</summary>
        public static void Show(LogLevel most)
        {
            // Nothing between Off and Warning is left to show.
            ForewalkLog.Listen(Write, most == LogLevel.Error ? LogLevel.Off : most);
        }

        private static void Write(LogLevel level, string message)
        {
            if (level == LogLevel.Warning) Debug.LogWarning("forewalk: " + message);
            if (level == LogLevel.Info) Debug.Log("forewalk: " + message);
        }
    }
}
