# Tests of rdw/, one forewalk_test() a file.
