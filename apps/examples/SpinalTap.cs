// The C interface for C# (Mono, .NET, Unity): spinaltap_c.h says what each call does. Put this file and libspinaltap.so
// into the project. Structs are what C has: hand them over by `ref`, which copies and allocates nothing.
using System;
using System.Runtime.InteropServices;

namespace SpinalTap {

[StructLayout(LayoutKind.Sequential)]
public struct Vec3 {
  public double x, y, z;
  public Vec3(double x, double y, double z) { this.x = x; this.y = y; this.z = z; }
}

[StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
public struct Error {
  public uint structBytes;
  public int code;
  [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 1024)] public string text;
}

[StructLayout(LayoutKind.Sequential)]
public struct Tool {
  public uint structBytes;
  public int shape;  // 0 drill, 1 round burr, 2 conical burr, 3 tapered screw, 5 plate
  public double diameterMm, lengthMm, tipLengthMm, tipDiameterMm, shankDiameterMm, thicknessMm, strokeMm;
}

[StructLayout(LayoutKind.Sequential)]
public struct Options {
  public uint structBytes;
  public int hasClearances, followsPath, hasDevice, usesVoxels, stopOnBreach;
  public double spacingMm, radiusMm, leadInMm, rpm, stopThrustN, stopClearanceMm;
  public IntPtr progress, user;
}

[StructLayout(LayoutKind.Sequential)]
public struct Input {
  public uint structBytes;
  public int spindleOn;
  public double dtS;
  public Vec3 tipMm, axis, side;
}

[StructLayout(LayoutKind.Sequential)]
public struct Cycle {
  public uint structBytes;
  public int state;
  public ulong index;
  public double timeS, depthMm;
  public Vec3 forceN;
  public double thrustN, torqueNMm, feedMmPerTurn, tipDensityGCm3;
  public Vec3 lateralN, contactN;
  public double clearanceOuterMm, clearanceCanalMm, insideMm, aheadMm;
  public ulong removed;
  public double removedMm3;
  public Vec3 tipMm, axis;
}

[StructLayout(LayoutKind.Sequential)]
public struct Block {
  public uint structBytes;
  public int x, y, z;
  public uint vertexCount, triangleCount, wallBegin;
}

public static class Native {
  const string Library = "spinaltap";  // libspinaltap.so

  public static uint SizeOf<T>() { return (uint)Marshal.SizeOf(typeof(T)); }
  /// Throws where a call failed.
  public static void Must(int code, ref Error error) {
    if (code != 0) throw new InvalidOperationException(error.text);
  }

  [DllImport(Library)] public static extern int spinaltap_bone_load(string file, out IntPtr bone, ref Error error);
  [DllImport(Library)] public static extern void spinaltap_bone_free(IntPtr bone);
  [DllImport(Library)] public static extern int spinaltap_bone_bounds(IntPtr bone, out Vec3 low, out Vec3 high,
                                                                      ref Error error);
  [DllImport(Library)] public static extern void spinaltap_tool_default(ref Tool tool);
  [DllImport(Library)] public static extern void spinaltap_session_options_default(ref Options options);
  /// `path`: IntPtr.Zero for none.
  [DllImport(Library)] public static extern int spinaltap_session_new(IntPtr[] bones, uint count, IntPtr path,
                                                                      ref Options options, out IntPtr session,
                                                                      ref Error error);
  [DllImport(Library)] public static extern void spinaltap_session_free(IntPtr session);
  [DllImport(Library)] public static extern int spinaltap_session_chosen(IntPtr session, byte[] text, uint bytes);
  [DllImport(Library)] public static extern int spinaltap_session_step(IntPtr session, ref Input input,
                                                                       ref Cycle cycle);
  [DllImport(Library)] public static extern int spinaltap_session_set_tool(IntPtr session, ref Tool tool,
                                                                           ref Error error);
  [DllImport(Library)] public static extern uint spinaltap_session_event_count(IntPtr session);
  [DllImport(Library)] public static extern int spinaltap_session_surface(IntPtr session, uint bone,
                                                                          out IntPtr changes, ref Error error);
  [DllImport(Library)] public static extern uint spinaltap_surface_block_count(IntPtr surface);
  [DllImport(Library)] public static extern int spinaltap_surface_block(IntPtr surface, uint number, ref Block block);
  [DllImport(Library)] public static extern int spinaltap_surface_copy(IntPtr surface, uint number, float[] verticesMm,
                                                                       float[] normals, ushort[] triangles);
  [DllImport(Library)] public static extern void spinaltap_surface_free(IntPtr surface);
}

/// From patient LPS (right-handed, mm) into an engine's left-handed frame, and back. Places; directions go the same way
/// without the scale. Faces turn: swap two corners of each triangle.
public static class Frames {
  /// Unity: x right, y up, z forward, m.
  public static Vec3 ToUnity(Vec3 p) { return new Vec3(0.001 * p.x, 0.001 * p.z, 0.001 * p.y); }
  public static Vec3 FromUnity(Vec3 u) { return new Vec3(1000.0 * u.x, 1000.0 * u.z, 1000.0 * u.y); }
  /// Unreal: x forward, y right, z up, cm.
  public static Vec3 ToUnreal(Vec3 p) { return new Vec3(0.1 * p.x, -0.1 * p.y, 0.1 * p.z); }
  public static Vec3 FromUnreal(Vec3 u) { return new Vec3(10.0 * u.x, -10.0 * u.y, 10.0 * u.z); }
  /// Corners of triangles, three a triangle, for either of them.
  public static void Turn(ushort[] triangles) {
    for (int n = 0; n + 2 < triangles.Length; n += 3) {
      ushort corner = triangles[n + 1];
      triangles[n + 1] = triangles[n + 2];
      triangles[n + 2] = corner;
    }
  }
}

}  // namespace SpinalTap
