within Hydraulic;
type SpoolCentre = enumeration(
  closed "All ports closed",
  open "All ports joined",
  tandem "P joined to T, A and B closed",
  float "A, B and T joined, P closed",
  regenerative "P, A and B joined, T closed") "What the middle position of a 4/3 valve joins"
  annotation(Documentation(info = "<html><p>The middle positions in common use, symbols after ISO 1219-1: <code>closed</code> holds the consumer, <code>open</code> lets pump and consumer idle, <code>tandem</code> lets the pump idle and holds the consumer, <code>float</code> lets the consumer move freely, <code>regenerative</code> gives both sides of the consumer the supply.</p></html>"));
