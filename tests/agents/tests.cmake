# Tests of agents/, one forewalk_test() a file.
forewalk_test(agents/crowd_test.cpp LIBS forewalk::agents)
forewalk_test(agents/locomotion_test.cpp LIBS forewalk::agents_clips)
forewalk_test(agents/trajectory_search_test.cpp LIBS forewalk::agents)
forewalk_test(agents/golaem_test.cpp LIBS forewalk::agents)
