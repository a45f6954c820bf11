"""From a folder with a CT to the force at each step: python3 bake_and_drill.py CT_FOLDER"""
import sys

import spinaltap

bone = spinaltap.Bone.from_ct(sys.argv[1], progress=lambda stage, share: print(f"\r{stage} {share:.0%}  ", end=""))
path = next(found.path for found in bone.suggest() if found.path)
session = spinaltap.Session(bone, path)
motion = spinaltap.PlannedMotion(path, feed_mm_s=1.0, tremor_mm=0.05)
for pose in motion.poses():
    cycle = session.step(pose[:3], pose[3:], motion.dt_s)
    print(f"{cycle.time_s:.3f} s  {cycle.depth_mm:6.3f} mm  thrust {cycle.thrust_n:5.1f} N  force {cycle.force_n} N")
