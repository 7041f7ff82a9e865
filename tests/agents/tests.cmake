# Tests of agents/, one forewalk_test() a file.
forewalk_test(agents/crowd_test.cpp LIBS forewalk::agents)
forewalk_test(agents/conformance_test.cpp LIBS forewalk::agents)
forewalk_test(agents/neighbourhood_test.cpp LIBS forewalk::agents)
forewalk_test(agents/navigation_test.cpp LIBS forewalk::agents forewalk::navmesh_build)
forewalk_test(agents/social_forces_test.cpp LIBS forewalk::agents)
forewalk_test(agents/hrvo_test.cpp LIBS forewalk::agents)
forewalk_test(agents/avatar_navigation_test.cpp LIBS forewalk::agents)
forewalk_test(agents/half_planes_test.cpp LIBS forewalk::agents)
