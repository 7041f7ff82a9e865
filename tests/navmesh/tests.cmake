# Tests of navmesh/, one forewalk_test() a file.
