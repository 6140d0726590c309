import { styleTags, tags as t } from "@lezer/highlight";

export const highlighting = styleTags({
  "Fence": t.meta,
  "HeaderText": t.docString,
  "FreeText! QuotedText": t.string,
  "Shall Satisfy": t.definitionKeyword,
  "Component/Identifier Component/QuotedName": t.className,
  "VariableName/Identifier VariableName/QuotedName ModeName/Mode NamedMode/Identifier NamedMode/QuotedName": t.variableName,
  "FunctionName/Identifier FunctionName/QuotedName": t.function(t.variableName),
  "Number Quantity Duration": t.number,
  "True False IsTrue IsFalse": t.bool,
  "CompareOp": t.compareOperator,
  "LogicOp Xor": t.logicOperator,
  "ArithOp Mod": t.arithmeticOperator,
  "And Or Not": t.operatorKeyword,
  "In During While Except Only Before After Mode Upon When Where If Unless Whenever Is Then": t.controlKeyword,
  "Immediately Initially At First Same Timepoint Next Finally Last Eventually Always Never Within For Until With ProbabilityWord": t.modifier,
  "The Previous OccurrenceWord Of": t.keyword,
  "( )": t.paren,
  ",": t.separator,
});
