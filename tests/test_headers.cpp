// Empty: the headers that all tests share are compiled with it (covtrace_precompile).
