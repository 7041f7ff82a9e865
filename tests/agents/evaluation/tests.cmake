# Tests of agents/evaluation/, one forewalk_test() a file.
forewalk_test(agents/evaluation/dtw_test.cpp LIBS forewalk::agents_evaluation)
forewalk_test(agents/evaluation/one_way_test.cpp LIBS forewalk::agents_evaluation Boost::headers)
forewalk_test(agents/evaluation/studentized_range_test.cpp LIBS forewalk::agents_evaluation Boost::headers)
forewalk_test(agents/evaluation/post_hoc_test.cpp LIBS forewalk::agents_evaluation)
forewalk_test(agents/evaluation/separation_test.cpp LIBS forewalk::agents_evaluation)
forewalk_test(agents/evaluation/matched_separation_test.cpp LIBS forewalk::agents_evaluation)
forewalk_test(agents/evaluation/evaluation_readme_test.cpp LIBS forewalk::agents_evaluation)
forewalk_test(agents/evaluation/thesis_test.cpp LIBS forewalk::agents_evaluation nlohmann_json::nlohmann_json)
if(TARGET thesis_test)
  target_compile_definitions(thesis_test PRIVATE
    FOREWALK_SHARED_REFERENCE="${FOREWALK_SHARED_DATA}/../reference")
endif()
