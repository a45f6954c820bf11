"""consumer.py BONE PLAN RECORD: what consumer.cpp does, with the installed Python package."""

import sys

import spinaltap

bone = spinaltap.Bone.load(sys.argv[1])
path = spinaltap.read_plan(sys.argv[2])[0]
session = spinaltap.Session(bone, path)
session.record(sys.argv[3])
session.drill(spinaltap.PlannedMotion(path))
session.end_record()
again = spinaltap.replay(sys.argv[3], bone)
print("SpinalTap", spinaltap.__version__)
print("record", spinaltap.read_record(sys.argv[3]).hash)
sys.exit(0 if again.is_same else 1)
