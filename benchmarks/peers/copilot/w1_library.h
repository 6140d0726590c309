extern bool a;
extern bool b;
void verdict(bool verdict_arg0);
void step(void);
