// Preloaded where leaks are looked for: a leak of a library that has been unloaded, as Mesa's drivers are, has no name.
extern "C" int dlclose(void*) { return 0; }
