// The scripts on the package's page, compiled as they stand, in the scene that the page tells to make.
using System;
using System.Reflection;
using Forewalk;
using Forewalk.Unity;
using UnityEngine;

namespace Laws
{
    public static class Page
    {
        public static void ScriptsDoWhatItSays(string assembly)
        {
            Assembly scripts = Assembly.LoadFrom(assembly);
            scripts.GetType("Corridor").GetMethod("Walk").Invoke(null, null);

            Stub.Clear();
            RedirectedRig rig = Rigs.HallWithRig(new Vector3(0, 0, -5), 0, out Transform camera);
            rig.controller = Controller.None;
            Component sign = new GameObject("Script").AddComponent(scripts.GetType("ResetSign"));
            TextMesh text = new GameObject("Sign").AddComponent<TextMesh>();
            Transform arrow = new GameObject("Arrow").transform;
            Set(sign, "rig", rig);
            Set(sign, "sign", text);
            Set(sign, "arrow", arrow);
            rig.gameObject.AddComponent(scripts.GetType("MyRoom"));

            // Straight ahead along the room's 6 m, from its middle, clear of the pillar: a reset is called
            // for before its end, further than the 4 x 4 m that the rig's fields say would let them.
            double z = 0;
            for (int i = 0; i < 400 && text.text == ""; ++i)
            {
                Check.That(i == 0 || !arrow.gameObject.activeSelf, "an arrow without a reset");
                z = i / 90.0;
                Rigs.Track(camera, Made.Head(0, z, 0));
                Stub.Frame(1f / 90);
            }
            Check.That(z > 2 && z < 3, $"the sign shows '{text.text}' at {z:F2} m");
            Check.That(text.text.StartsWith("Stop"), text.text);
            Check.That(arrow.gameObject.activeSelf, "no arrow");
            Vector3 along = arrow.rotation * Vector3.forward, to = arrow.position - camera.position;
            Check.That(along.z < -0.99f && to.z < -0.99f, "the arrow leads back");
            Check.That((text.transform.position - camera.position).z > 1.4f, "the sign is ahead");
        }

        private static void Set(Component script, string field, object value) =>
            script.GetType().GetField(field).SetValue(script, value);
    }
}
