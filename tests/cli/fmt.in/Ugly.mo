model Ugly   "Blanks as they came"


Real x(start=1,fixed = true) ; // the state
parameter Real  k=- 2;
equation
    der(x)=k*( x-1 );
end Ugly;
