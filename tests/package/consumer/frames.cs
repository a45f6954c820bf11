// frames BONE: SpinalTap.cs' left-handed frames, with the surface of a bone: places come back, and triangles whose
// corners were turned face outward by the left hand's rule, as their vertices' normals say.
using System;
using SpinalTap;

static class FramesTest {
  delegate Vec3 Map(Vec3 p);

  static Vec3 Minus(Vec3 a, Vec3 b) { return new Vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
  static double Dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static Vec3 Cross(Vec3 a, Vec3 b) {
    return new Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  }
  static Vec3 At(float[] values, int n) { return new Vec3(values[3 * n], values[3 * n + 1], values[3 * n + 2]); }

  static void Expect(bool is_so, string what) {
    if (!is_so) throw new InvalidOperationException("expected " + what);
  }

  /// How many triangles face as their normals say, and how many do not.
  static void Check(IntPtr surface, Map to, Map from, string name) {
    Vec3 x = to(new Vec3(1, 0, 0)), y = to(new Vec3(0, 1, 0)), z = to(new Vec3(0, 0, 1));
    Expect(Dot(Cross(x, y), z) < 0, name + " to be left-handed");
    long outward = 0, inward = 0;
    for (uint n = 0; n < Native.spinaltap_surface_block_count(surface); ++n) {
      Block block = new Block { structBytes = Native.SizeOf<Block>() };
      Native.spinaltap_surface_block(surface, n, ref block);
      float[] vertices = new float[3 * block.vertexCount], normals = new float[3 * block.vertexCount];
      ushort[] triangles = new ushort[3 * block.triangleCount];
      Native.spinaltap_surface_copy(surface, n, vertices, normals, triangles);
      Frames.Turn(triangles);
      for (int t = 0; t + 2 < triangles.Length; t += 3) {
        Vec3 a = At(vertices, triangles[t]);
        Vec3 back = Minus(from(to(a)), a);
        Expect(Dot(back, back) < 1e-18, name + " to come back");
        // Clockwise as seen from outside: in a left-handed frame the cross product, whose formula knows no hand, then
        // points outward.
        Vec3 face = Cross(Minus(to(At(vertices, triangles[t + 1])), to(a)), Minus(to(At(vertices, triangles[t + 2])), to(a)));
        if (Dot(face, to(At(normals, triangles[t]))) > 0) ++outward; else ++inward;
      }
    }
    // Of slivers at sharp edges a vertex' normal may say otherwise.
    Expect(outward > 1000 && inward < 0.02 * outward, name + ": faces outward, found " + outward + " and " + inward);
  }

  static int Main(string[] arguments) {
    Error error = new Error { structBytes = Native.SizeOf<Error>() };
    IntPtr bone, session, surface;
    Native.Must(Native.spinaltap_bone_load(arguments[0], out bone, ref error), ref error);
    Options options = new Options { structBytes = Native.SizeOf<Options>() };
    Native.spinaltap_session_options_default(ref options);
    options.spacingMm = 0.5;
    options.hasClearances = 0;
    Native.Must(Native.spinaltap_session_new(new[] { bone }, 1, IntPtr.Zero, ref options, out session, ref error),
                ref error);
    Native.Must(Native.spinaltap_session_surface(session, 0, out surface, ref error), ref error);
    Check(surface, Frames.ToUnity, Frames.FromUnity, "Unity's frame");
    Check(surface, Frames.ToUnreal, Frames.FromUnreal, "Unreal's frame");
    Console.WriteLine("frames are left-handed, and faces outward");
    return 0;
  }
}
