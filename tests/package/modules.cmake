# The modules of the code, in their order: each may use those before it and none after it.
set(modules core/base core/ct core/phantom core/segment core/surface core/rbf core/tool core/points core/engine core/force
    core/heat core/anatomy core/grading core/uncertainty core/plan core/registration core/session/operator core/session/coupling core/session/device core/session core/session/record core/session/real_time core/sound core/study core/files core/validation
    vdb vdb/grid vdb/bake vdb/engine vdb/remaining vdb/picture vdb/heat vdb/sim mesh apps/report apps/link apps/spinaltap
    apps/spinaltap-planner apps/examples apps/python)
