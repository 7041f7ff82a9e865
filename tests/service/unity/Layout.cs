// What C# has of the structs, constants and version that a forewalk.h declares.
using System;
using System.Collections.Generic;
using System.IO;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Text;
using System.Text.RegularExpressions;
using Forewalk;

namespace Laws
{
    public static class Layout
    {
        private static readonly Assembly package = typeof(ForewalkSession).Assembly;

        // Longer ones first: the first that fits counts.
        private static readonly KeyValuePair<string, Type>[] enums = {
            Prefix("FOREWALK_RESET_PHASE_", typeof(ResetPhase)),
            Prefix("FOREWALK_RESET_", typeof(ResetMethod)),
            Prefix("FOREWALK_LOG_", typeof(LogLevel)),
            Prefix("FOREWALK_AXES_", typeof(Axes)),
            Prefix("FOREWALK_PARTITION_", typeof(Partition)),
            Prefix("FOREWALK_CONTROLLER_", typeof(Controller)),
            Prefix("FOREWALK_LIMITS_", typeof(GainLimits)),
            Prefix("FOREWALK_METHOD_", typeof(PredictionMethod)),
            Prefix("FOREWALK_HEADING_", typeof(HeadingSource)),
            Prefix("FOREWALK_INSTRUCTION_", typeof(ResetInstruction)),
            Prefix("FOREWALK_FLAG_", typeof(FrameFlags)),
            Prefix("FOREWALK_NODE_", typeof(NodeKind)),
            Prefix("FOREWALK_REASON_", typeof(TerminalReason)),
            Prefix("FOREWALK_WAY_", typeof(WayChange)),
            Prefix("FOREWALK_SHAPE_", typeof(ObstacleShape)),
            Prefix("FOREWALK_", typeof(Status))
        };

        private static KeyValuePair<string, Type> Prefix(string prefix, Type type) =>
            new KeyValuePair<string, Type>(prefix, type);

        /// <summary>A line for each struct, field, constant and function that the header declares, in its
        /// order: "name value", "missing" where C# has none. A struct's value is its size, a field's its
        /// offset.</summary>
        public static void Print(string header)
        {
            string text = Regex.Replace(File.ReadAllText(header), @"/\*.*?\*/", " ",
                                        RegexOptions.Singleline);
            foreach (Match block in Regex.Matches(text, @"typedef struct (\w+) \{(.*?)\}",
                                                  RegexOptions.Singleline))
            {
                PrintStruct(block.Groups[1].Value, block.Groups[2].Value);
            }
            foreach (Match constant in Regex.Matches(text, @"\b(FOREWALK_[A-Z0-9_]+) ="))
            {
                PrintConstant(constant.Groups[1].Value);
            }
            foreach (string part in new[] { "Major", "Minor", "Patch" })
            {
                object value = typeof(ForewalkLibrary).GetField("Version" + part).GetRawConstantValue();
                Console.WriteLine($"FOREWALK_VERSION_{part.ToUpperInvariant()} {value}");
            }
            Type native = package.GetType("Forewalk.Native");
            foreach (Match function in Regex.Matches(text, @"FOREWALK_API [^;]*?(forewalk_\w+)\("))
            {
                string name = function.Groups[1].Value;
                bool isThere = native.GetMethod(name, BindingFlags.Static | BindingFlags.Public) != null;
                // SafeHandles own what they hold once: they never need a second owner.
                if (!isThere && !name.EndsWith("_retain")) Console.WriteLine(name + " missing");
            }
        }

        private static void PrintStruct(string name, string body)
        {
            string ours = Upper(name.Substring("forewalk_".Length));
            Type type = package.GetType("Forewalk.Native" + ours) ?? package.GetType("Forewalk." + ours) ??
                        package.GetType("Forewalk.Forewalk" + ours);
            Console.WriteLine($"{name} {(type == null ? "missing" : Marshal.SizeOf(type).ToString())}");
            if (type == null) return;
            int fields = 0;
            foreach (string declaration in body.Split(';'))
            {
                Match names = Regex.Match(declaration.Trim(), @"^(?:const )?\w+\s*\*?\s*(\w.*)$",
                                          RegexOptions.Singleline);
                if (!names.Success) continue;
                foreach (string field in names.Groups[1].Value.Split(','))
                {
                    string plain = Regex.Match(field, @"\w+").Value;
                    Match array = Regex.Match(field, @"\[(\d+)\]");
                    fields += array.Success ? int.Parse(array.Groups[1].Value) : 1;
                    FieldInfo found = Field(type, Upper(plain)) ?? Field(type, Upper(plain) + "0");
                    Console.WriteLine(
                        $"{name}.{plain} " +
                        (found == null ? "missing" : Marshal.OffsetOf(type, found.Name).ToString()));
                }
            }
            Check.Equal(type.GetFields(All).Length, fields, "fields of " + type);
            Check.That(IsBlittable(type), type + " is not blittable");
        }

        private const BindingFlags All =
            BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic;

        private static FieldInfo Field(Type type, string name) => type.GetField(name, All);

        private static bool IsBlittable(Type type)
        {
            if (type.IsPointer || type == typeof(IntPtr) || type == typeof(UIntPtr)) return true;
            if (type.IsEnum) return IsBlittable(Enum.GetUnderlyingType(type));
            if (type.IsPrimitive) return type != typeof(bool) && type != typeof(char);
            if (!type.IsValueType || !type.IsLayoutSequential) return false;
            foreach (FieldInfo field in type.GetFields(All))
            {
                if (!IsBlittable(field.FieldType)) return false;
            }
            return true;
        }

        private static void PrintConstant(string name)
        {
            foreach (KeyValuePair<string, Type> some in enums)
            {
                if (!name.StartsWith(some.Key)) continue;
                string rest = name.Substring(some.Key.Length).Replace("_", "");
                foreach (string member in Enum.GetNames(some.Value))
                {
                    if (!member.Equals(rest, StringComparison.OrdinalIgnoreCase)) continue;
                    Console.WriteLine($"{name} {Convert.ToInt64(Enum.Parse(some.Value, member))}");
                    return;
                }
                break;
            }
            Console.WriteLine(name + " missing");
        }

        private static string Upper(string snake)
        {
            var camel = new StringBuilder();
            foreach (string word in snake.Split('_'))
            {
                camel.Append(char.ToUpperInvariant(word[0])).Append(word.Substring(1));
            }
            return camel.ToString();
        }
    }
}
