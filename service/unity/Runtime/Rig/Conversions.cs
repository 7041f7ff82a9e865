// Forewalk's plain values are Unity's, under other names: same axes, same units.
using UnityEngine;

namespace Forewalk.Unity
{
    public static class Conversions
    {
        public static Vec3 ToForewalk(this Vector3 v) => new Vec3(v.x, v.y, v.z);
        public static Quat ToForewalk(this Quaternion q) => new Quat(q.x, q.y, q.z, q.w);
        /// <summary>A point of the tracked room seen from above: x to the right, y forward.</summary>
        public static Point2 ToForewalk(this Vector2 v) => new Point2(v.x, v.y);

        public static Vector3 ToUnity(this Vec3 v) => new Vector3(v.X, v.Y, v.Z);
        public static Quaternion ToUnity(this Quat q) => new Quaternion(q.X, q.Y, q.Z, q.W);
    }
}
