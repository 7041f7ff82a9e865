# Tests of service/, one forewalk_test() a file.
