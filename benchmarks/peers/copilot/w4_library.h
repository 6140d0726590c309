extern bool a;
extern bool b;
extern bool c;
void verdict(bool verdict_arg0);
void step(void);
