# Tests of agents/, one forewalk_test() a file.
forewalk_test(agents/crowd_test.cpp LIBS forewalk::agents)
forewalk_test(agents/caacd_test.cpp LIBS forewalk::agents)
