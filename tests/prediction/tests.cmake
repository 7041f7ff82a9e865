# Tests of prediction/, one forewalk_test() a file.
