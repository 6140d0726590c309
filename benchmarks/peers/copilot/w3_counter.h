extern bool b;
extern bool a;
void verdict(bool verdict_arg0);
void step(void);
