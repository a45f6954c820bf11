// tool_change BONE: tool_change.c in C#, with SpinalTap.cs: a burr in a hand, a pedal, the surface for a renderer.
using System;
using System.Globalization;
using System.Text;
using SpinalTap;

static class ToolChange {
  static Error error = new Error { structBytes = Native.SizeOf<Error>() };

  /// Thirty times a second: what changed goes to the renderer, a mesh a block.
  static uint Draw(IntPtr session) {
    IntPtr changes;
    Native.Must(Native.spinaltap_session_surface(session, 0, out changes, ref error), ref error);
    uint count = Native.spinaltap_surface_block_count(changes);
    for (uint n = 0; n < count; ++n) {
      Block block = new Block { structBytes = Native.SizeOf<Block>() };
      Native.spinaltap_surface_block(changes, n, ref block);
      float[] verticesMm = new float[3 * block.vertexCount];
      ushort[] triangles = new ushort[3 * block.triangleCount];
      Native.spinaltap_surface_copy(changes, n, verticesMm, null, triangles);
      // In Unity: Frames.ToUnity() of each vertex, Frames.Turn(triangles), into the Mesh of (block.x, block.y, block.z);
      // no vertices: take that Mesh away.
    }
    Native.spinaltap_surface_free(changes);
    return count;
  }

  static int Main(string[] arguments) {
    if (arguments.Length != 1) return 2;
    try {
      IntPtr bone, session;
      Vec3 low, high;
      Native.Must(Native.spinaltap_bone_load(arguments[0], out bone, ref error), ref error);
      Native.Must(Native.spinaltap_bone_bounds(bone, out low, out high, ref error), ref error);
      Options options = new Options { structBytes = Native.SizeOf<Options>() };
      Native.spinaltap_session_options_default(ref options);
      options.spacingMm = 0.2;
      options.hasClearances = 0;
      Native.Must(Native.spinaltap_session_new(new[] { bone }, 1, IntPtr.Zero, ref options, out session, ref error),
                  ref error);
      Native.spinaltap_bone_free(bone);  // the session has what it needs
      byte[] chosen = new byte[120];
      Native.spinaltap_session_chosen(session, chosen, (uint)chosen.Length);
      Console.WriteLine(Encoding.UTF8.GetString(chosen, 0, Array.IndexOf(chosen, (byte)0)));

      Tool burr = new Tool { structBytes = Native.SizeOf<Tool>() };
      Native.spinaltap_tool_default(ref burr);
      burr.shape = 1;
      burr.diameterMm = 4.0;
      burr.shankDiameterMm = 2.5;
      Native.Must(Native.spinaltap_session_set_tool(session, ref burr, ref error), ref error);
      uint blocks = Draw(session);
      Input input = new Input {
        structBytes = Native.SizeOf<Input>(), spindleOn = 1, dtS = 0.001, axis = new Vec3(0, 0, -1)
      };
      Cycle cycle = new Cycle { structBytes = Native.SizeOf<Cycle>() };
      double maxN = 0.0;
      for (int n = 0; n < 5000; ++n) {
        if (n == 2500) {  // the pedal
          burr.diameterMm = 3.0;
          Native.Must(Native.spinaltap_session_set_tool(session, ref burr, ref error), ref error);
        }
        input.tipMm = new Vec3(0.5 * (low.x + high.x), 0.75 * low.y + 0.25 * high.y, high.z + 2.0 - 0.004 * n);
        if (Native.spinaltap_session_step(session, ref input, ref cycle) != 0) return 1;
        maxN = Math.Max(maxN, cycle.thrustN);  // cycle.forceN is what the device gives
        if (n % 33 == 0) blocks += Draw(session);
      }
      Console.WriteLine(string.Format(CultureInfo.InvariantCulture,
                                      "{0:F1} s, {1:F2} N at most, {2} blocks of surface drawn, {3} events", cycle.timeS,
                                      maxN, blocks, Native.spinaltap_session_event_count(session)));
      Native.spinaltap_session_free(session);
    } catch (InvalidOperationException problem) {
      Console.Error.WriteLine(problem.Message);
      return 2;
    }
    return 0;
  }
}
